// Where the levels of a pyramid lie in one texture: level 1 at the lower left, the smaller ones above
// one another on its right.
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
  ivec2 origin = ivec2(0);
  for (int i = 2; i <= level; i++) {
    origin = ivec2(level_size(size, 1).x, (i == 2) ? 0 : origin.y + level_size(size, i - 1).y);
  }
  return origin;
}

#endif
