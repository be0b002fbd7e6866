// Light that a picture can hold: what is not a number, or beyond all bounds, is dropped.
#ifndef FINITE_LIB_GLSL
#define FINITE_LIB_GLSL

// Radiance above which light is dropped. Far above any lamp, and far enough below the largest float
// (3e38) that gains and sums over all samples of a picture stay finite. The same as
// LARGEST_RADIANCE of addon/snapshot/surface_graph.py.
#define LARGEST_RADIANCE 1e30

// Channel by channel, as Cycles drops light. Found by the bits: a compiler may assume that there is no
// NaN and remove a comparison.
vec3 finite_light(vec3 light)
{
  uvec3 magnitude = floatBitsToUint(light) & uvec3(0x7fffffffu);
  uvec3 largest = uvec3(floatBitsToUint(LARGEST_RADIANCE));
  return mix(light, vec3(0.0), greaterThan(magnitude, largest));
}

// 0 where there is no number; infinite ones stay.
float number_or_zero(float value)
{
  return ((floatBitsToUint(value) & 0x7fffffffu) > 0x7f800000u) ? 0.0 : value;
}

vec3 number_or_zero(vec3 value)
{
  uvec3 magnitude = floatBitsToUint(value) & uvec3(0x7fffffffu);
  return mix(value, vec3(0.0), greaterThan(magnitude, uvec3(0x7f800000u)));
}

#endif
