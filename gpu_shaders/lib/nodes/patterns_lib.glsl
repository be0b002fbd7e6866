// Blender's Wave, Magic, Checker, Brick and Gradient textures.
// Formulas: Blender's manual, and measurements of Cycles.
#ifndef PATTERNS_LIB_GLSL
#define PATTERNS_LIB_GLSL

#define PATTERN_PI 3.14159265358979

// Keeps whole numbers from lying on either side by rounding.
vec3 off_whole(vec3 p)
{
  return (p + 0.000001) * 0.999999;
}

#define WAVE_SIN 0
#define WAVE_SAW 1
#define WAVE_TRI 2

float wave_profile(float phase, int profile)
{
  if (profile == WAVE_SIN) {
    return 0.5 + 0.5 * sin(phase - 0.5 * PATTERN_PI);
  }
  float turns = phase / (2.0 * PATTERN_PI);
  return (profile == WAVE_SAW) ? fract(turns) : 2.0 * abs(turns - floor(turns + 0.5));
}

// Lights of three waves, each fed back into the next, `depth` times.
vec3 magic_pattern(vec3 place, float scale, int depth, float distortion)
{
  vec3 p = 5.0 * scale * (place - 2.0 * PATTERN_PI * trunc(place / (2.0 * PATTERN_PI)));
  float x = sin(p.x + p.y + p.z);
  float y = cos(-p.x + p.y - p.z);
  float z = -cos(-p.x - p.y + p.z);
  float d = distortion;
  if (depth > 0) {
    x *= d;
    y *= d;
    z *= d;
    y = -cos(x - y + z) * d;
  }
  x = (depth > 1) ? cos(x - y - z) * d : x;
  z = (depth > 2) ? sin(-x - y - z) * d : z;
  x = (depth > 3) ? -cos(-x + y - z) * d : x;
  y = (depth > 4) ? -sin(-x + y + z) * d : y;
  y = (depth > 5) ? -cos(-x + y + z) * d : y;
  x = (depth > 6) ? cos(x + y + z) * d : x;
  z = (depth > 7) ? sin(x + y - z) * d : z;
  x = (depth > 8) ? -cos(-x - y + z) * d : x;
  y = (depth > 9) ? -sin(x - y + z) * d : y;
  vec3 waves = vec3(x, y, z);
  return 0.5 - ((d != 0.0) ? waves / (2.0 * d) : waves);
}

// 1 in every other cell.
float checker_pattern(vec3 place)
{
  ivec3 cell = abs(ivec3(floor(off_whole(place)))) & 1;
  return ((cell.x == cell.y) == (cell.z == 1)) ? 1.0 : 0.0;
}

// A number of a brick from 0 to 1.
float brick_random(int number)
{
  uint n = (uint(number) + 1013u) & 0x7fffffffu;
  n = (n >> 13u) ^ n;
  uint mixed = (n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu;
  return 0.5 * (float(mixed) / 1073741824.0);
}

// Share of the second colour in a brick (x) and of mortar (y).
vec2 brick_pattern(vec3 p,
                   float mortar_size,
                   float mortar_smooth,
                   float bias,
                   float width,
                   float height,
                   float offset,
                   int offset_every,
                   float squash,
                   int squash_every)
{
  int row = int(floor(p.y / height));
  float shift = 0.0;
  if (offset_every != 0 && squash_every != 0) {
    // Remainders of negative numbers are open in GLSL; only 0 counts.
    width *= (abs(row) % squash_every != 0) ? 1.0 : squash;
    shift = (abs(row) % offset_every != 0) ? 0.0 : width * offset;
  }
  int column = int(floor((p.x + shift) / width));
  float x = (p.x + shift) - width * float(column), y = p.y - height * float(row);
  float tint = clamp(brick_random((row << 16) + (column & 0xffff)) + bias, 0.0, 1.0);
  float edge = min(min(x, y), min(width - x, height - y));
  if (edge >= mortar_size) {
    return vec2(tint, 0.0);
  }
  if (mortar_smooth == 0.0) {
    return vec2(tint, 1.0);
  }
  float depth = 1.0 - edge / mortar_size;
  float t = clamp(depth / mortar_smooth, 0.0, 1.0);
  return vec2(tint, (depth < mortar_smooth) ? t * t * (3.0 - 2.0 * t) : 1.0);
}

#define GRADIENT_LINEAR 0
#define GRADIENT_QUADRATIC 1
#define GRADIENT_EASING 2
#define GRADIENT_DIAGONAL 3
#define GRADIENT_RADIAL 4
#define GRADIENT_QUADRATIC_SPHERE 5
#define GRADIENT_SPHERICAL 6

float gradient_pattern(vec3 p, int type)
{
  float value = p.x;
  if (type == GRADIENT_QUADRATIC) {
    value = max(p.x, 0.0) * max(p.x, 0.0);
  }
  else if (type == GRADIENT_EASING) {
    float t = clamp(p.x, 0.0, 1.0);
    value = t * t * (3.0 - 2.0 * t);
  }
  else if (type == GRADIENT_DIAGONAL) {
    value = 0.5 * (p.x + p.y);
  }
  else if (type == GRADIENT_RADIAL) {
    value = ((p.x != 0.0 || p.y != 0.0) ? atan(p.y, p.x) : 0.0) / (2.0 * PATTERN_PI) + 0.5;
  }
  else if (type >= GRADIENT_QUADRATIC_SPHERE) {
    float inside = max(0.999999 - length(p), 0.0);
    value = (type == GRADIENT_SPHERICAL) ? inside : inside * inside;
  }
  return clamp(value, 0.0, 1.0);
}

#endif
