// Least and largest value of any rectangle, from a stack of N-buffers (Decoret, EG 2005): layer i
// holds, at each texel, both over the square of 2^i texels that begins there.
#ifndef NBUFFER_LIB_GLSL
#define NBUFFER_LIB_GLSL

vec2 extremes(vec2 a, vec2 b)
{
  return vec2(min(a.x, b.x), max(a.y, b.y));
}

// Over the square of texels within `reach` of `center`, as far as it lies in the picture.
vec2 nbuffer_extremes(sampler2DArray levels_tx, ivec2 center, int reach)
{
  ivec3 size = textureSize(levels_tx, 0);
  int level = clamp(findMSB(2 * reach + 1), 0, size.z - 1);
  ivec2 low = max(center - reach, ivec2(0));
  ivec2 high = min(center + reach, size.xy - 1);
  // Squares that overlap cover the rectangle; where it is narrower than one, they cover a little
  // more than it.
  high = max(high - (1 << level) + 1, low);
  vec2 a = texelFetch(levels_tx, ivec3(low, level), 0).xy;
  vec2 b = texelFetch(levels_tx, ivec3(high.x, low.y, level), 0).xy;
  vec2 c = texelFetch(levels_tx, ivec3(low.x, high.y, level), 0).xy;
  vec2 d = texelFetch(levels_tx, ivec3(high, level), 0).xy;
  return extremes(extremes(a, b), extremes(c, d));
}

#endif
