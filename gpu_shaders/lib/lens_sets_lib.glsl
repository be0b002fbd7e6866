// Sets of places on the lens: neighbouring pixels of a layered picture see through other ones.
#ifndef LENS_SETS_LIB_GLSL
#define LENS_SETS_LIB_GLSL

// One for each pixel of a square of 4 x 4.
#define SETS 16

int lens_set(ivec2 pixel)
{
  return (pixel.x & 3) | ((pixel.y & 3) << 2);
}

#endif
