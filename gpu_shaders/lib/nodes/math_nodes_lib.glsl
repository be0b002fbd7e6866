// Blender's Math, Vector Math, Clamp and Map Range nodes: an operation a function. Undefined results
// (a division by 0, the root of a negative number) are 0, as in Cycles.
#ifndef MATH_NODES_LIB_GLSL
#define MATH_NODES_LIB_GLSL
#include "lib/finite_lib.glsl"
#include "lib/surface/vector_lib.glsl"

// Least difference that counts as none, as C's FLT_EPSILON.
#define MATH_EPSILON 1.1920929e-7

// Whole numbers to the precision of the type.
bool math_is_whole(float a)
{
  return a == floor(a);
}

float math_safe_divide(float a, float b)
{
  return (b != 0.0) ? a / b : 0.0;
}

float math_power(float a, float b)
{
  if (b == 0.0) {
    return 1.0;
  }
  if (a == 0.0) {
    return 0.0;
  }
  if (a > 0.0) {
    return pow(a, b);
  }
  if (!math_is_whole(b)) {
    return 0.0;
  }
  // GLSL leaves powers of negative numbers open.
  float size = pow(-a, b);
  return math_is_whole(0.5 * b) ? size : -size;
}

// Remainder with the sign of the dividend.
float math_modulo(float a, float b)
{
  return (b != 0.0) ? a - b * trunc(a / b) : 0.0;
}

float math_floored_modulo(float a, float b)
{
  return (b != 0.0) ? a - b * floor(a / b) : 0.0;
}

float math_logarithm(float a, float b)
{
  return (a > 0.0 && b > 0.0) ? math_safe_divide(log(a), log(b)) : 0.0;
}

float math_compare(float a, float b, float c)
{
  return (a == b || abs(a - b) <= max(c, MATH_EPSILON)) ? 1.0 : 0.0;
}

float math_smooth_min(float a, float b, float c)
{
  if (c == 0.0) {
    return min(a, b);
  }
  float h = max(c - abs(a - b), 0.0) / c;
  return min(a, b) - h * h * h * c / 6.0;
}

float math_smooth_max(float a, float b, float c)
{
  return -math_smooth_min(-a, -b, c);
}

float math_wrap(float a, float largest, float least)
{
  float range = largest - least;
  return (range != 0.0) ? a - range * floor((a - least) / range) : least;
}

float math_snap(float a, float b)
{
  return floor(math_safe_divide(a, b)) * b;
}

float math_pingpong(float a, float b)
{
  return (b != 0.0) ? abs(fract((a - b) / (2.0 * b)) * 2.0 * b - b) : 0.0;
}

vec3 vector_power(vec3 a, vec3 b)
{
  return vec3(math_power(a.x, b.x), math_power(a.y, b.y), math_power(a.z, b.z));
}

vec3 vector_modulo(vec3 a, vec3 b)
{
  return vec3(math_modulo(a.x, b.x), math_modulo(a.y, b.y), math_modulo(a.z, b.z));
}

vec3 vector_wrap(vec3 a, vec3 b, vec3 c)
{
  return vec3(math_wrap(a.x, b.x, c.x), math_wrap(a.y, b.y, c.y), math_wrap(a.z, b.z, c.z));
}

vec3 vector_project(vec3 a, vec3 b)
{
  float size = dot(b, b);
  return (size != 0.0) ? dot(a, b) / size * b : vec3(0.0);
}

vec3 vector_reflect(vec3 a, vec3 b)
{
  return reflect(a, safe_normalize(b));
}

vec3 vector_refract(vec3 a, vec3 b, float eta)
{
  return refract(a, safe_normalize(b), eta);
}

// `clamp` whose ends may be in any order.
float clamp_range(float a, float end, float other)
{
  return clamp(a, min(end, other), max(end, other));
}

vec3 clamp_range(vec3 a, vec3 end, vec3 other)
{
  return clamp(a, min(end, other), max(end, other));
}

// Place of a value in a range, 0 where the range has no length.
vec3 map_place(vec3 a, vec3 from_min, vec3 from_max)
{
  return safe_divide(a - from_min, from_max - from_min);
}

vec3 map_steps(vec3 place, vec3 steps)
{
  vec3 stepped = safe_divide(floor(place * (steps + 1.0)), steps);
  return mix(vec3(0.0), stepped, greaterThan(steps, vec3(0.0)));
}

vec3 map_smooth(vec3 place)
{
  vec3 t = clamp(place, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

vec3 map_smoother(vec3 place)
{
  vec3 t = clamp(place, 0.0, 1.0);
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

#endif
