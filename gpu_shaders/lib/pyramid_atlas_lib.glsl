// Where the levels of a pyramid lie in one texture: level 1 at the lower left, the smaller ones above
// one another on its right, as if the picture were as high as the next power of two: then no loop is
// needed to know where, and rays ask often.
#ifndef PYRAMID_ATLAS_LIB_GLSL
#define PYRAMID_ATLAS_LIB_GLSL

// Texels of a level, from 0, which is the picture itself.
ivec2 level_size(ivec2 size, int level)
{
  return (size + (1 << level) - 1) >> level;
}

// Lower left texel of a level, from 1.
ivec2 level_origin(ivec2 size, int level)
{
  int last = findMSB(max(size.y - 1, 1)) + 1, whole = 1 << last;
  // Of a wide picture there are levels of one row left then.
  int row = (whole >> 1) - (whole >> (level - 1)) + max(level - last - 1, 0);
  return (level < 2) ? ivec2(0) : ivec2((size.x + 1) >> 1, row);
}

#endif
