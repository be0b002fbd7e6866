// Ranges: least (x) and largest (y) value.
#ifndef EXTREMES_LIB_GLSL
#define EXTREMES_LIB_GLSL

// The range that holds two ranges.
vec2 extremes(vec2 a, vec2 b)
{
  return vec2(min(a.x, b.x), max(a.y, b.y));
}

#endif
