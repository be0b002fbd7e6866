// Pseudo-random numbers of numbers, as Blender's textures have them: Jenkins, lookup3 (public domain,
// 2006), of the bits of 1 to 4 floats.
#ifndef RANDOM_LIB_GLSL
#define RANDOM_LIB_GLSL

uint rotate_left(uint x, int k)
{
  return (x << k) | (x >> (32 - k));
}

uint jenkins_final(uint a, uint b, uint c)
{
  c = (c ^ b) - rotate_left(b, 14);
  a = (a ^ c) - rotate_left(c, 11);
  b = (b ^ a) - rotate_left(a, 25);
  c = (c ^ b) - rotate_left(b, 16);
  a = (a ^ c) - rotate_left(c, 4);
  b = (b ^ a) - rotate_left(a, 14);
  return (c ^ b) - rotate_left(b, 24);
}

uint jenkins(uint x)
{
  uint start = 0xdeadbeefu + (1u << 2u) + 13u;
  return jenkins_final(start + x, start, start);
}

uint jenkins(uvec2 k)
{
  uint start = 0xdeadbeefu + (2u << 2u) + 13u;
  return jenkins_final(start + k.x, start + k.y, start);
}

uint jenkins(uvec3 k)
{
  uint start = 0xdeadbeefu + (3u << 2u) + 13u;
  return jenkins_final(start + k.x, start + k.y, start + k.z);
}

uint jenkins(uvec4 k)
{
  uint start = 0xdeadbeefu + (4u << 2u) + 13u;
  uint a = start + k.x, b = start + k.y, c = start + k.z;
  a = (a - c) ^ rotate_left(c, 4);
  c += b;
  b = (b - a) ^ rotate_left(a, 6);
  a += c;
  c = (c - b) ^ rotate_left(b, 8);
  b += a;
  a = (a - c) ^ rotate_left(c, 16);
  c += b;
  b = (b - a) ^ rotate_left(a, 19);
  a += c;
  c = (c - b) ^ rotate_left(b, 4);
  b += a;
  return jenkins_final(a + k.w, b, c);
}

float random_unit(uint bits)
{
  return float(bits) / 4294967295.0;
}

float random_of(float k)
{
  return random_unit(jenkins(floatBitsToUint(k)));
}

float random_of(vec2 k)
{
  return random_unit(jenkins(floatBitsToUint(k)));
}

float random_of(vec3 k)
{
  return random_unit(jenkins(floatBitsToUint(k)));
}

float random_of(vec4 k)
{
  return random_unit(jenkins(floatBitsToUint(k)));
}

// Of the first 1 to 4 components. `dims` is a number that the compiler knows.
float random_of(vec4 k, int dims)
{
  if (dims == 1) {
    return random_of(k.x);
  }
  if (dims == 2) {
    return random_of(k.xy);
  }
  return (dims == 3) ? random_of(k.xyz) : random_of(k);
}

vec3 random_color_of(vec4 k, int dims)
{
  if (dims == 1) {
    return vec3(random_of(k.x), random_of(vec2(k.x, 1.0)), random_of(vec2(k.x, 2.0)));
  }
  if (dims == 2) {
    return vec3(random_of(k.xy), random_of(vec3(k.xy, 1.0)), random_of(vec3(k.xy, 2.0)));
  }
  if (dims == 3) {
    return vec3(random_of(k.xyz), random_of(vec4(k.xyz, 1.0)), random_of(vec4(k.xyz, 2.0)));
  }
  return vec3(random_of(k), random_of(k.zxwy), random_of(k.wzyx));
}

#endif
