// Gradient noise and its fractal sums with Blender's own numbers.
// Perlin, Improving noise, SIGGRAPH 2002; Musgrave, in Ebert et al., Texturing and modeling, 3rd ed.,
// 2003, chapter 16 (fBm, multifractal, hetero terrain, hybrid and ridged multifractal).
// Places are vec4 of which the first `dims` components count; `dims` is a number that the compiler
// knows, so that only one of the branches is left.
#ifndef NOISE_LIB_GLSL
#define NOISE_LIB_GLSL
#include "lib/nodes/random_lib.glsl"

#define NOISE_FBM 0
#define NOISE_MULTIFRACTAL 1
#define NOISE_HYBRID_MULTIFRACTAL 2
#define NOISE_RIDGED_MULTIFRACTAL 3
#define NOISE_HETERO_TERRAIN 4

// Numbers repeat after this distance, so that floats far away do not run out of digits.
#define NOISE_PERIOD 100000.0

float flip_if(float value, uint condition)
{
  return (condition != 0u) ? -value : value;
}

// Product of the offset from a corner of the lattice with the gradient there.
float corner_slope(ivec4 corner, vec4 d, int dims)
{
  if (dims == 1) {
    uint h = jenkins(uint(corner.x)) & 15u;
    return flip_if(1.0 + float(h & 7u), h & 8u) * d.x;
  }
  if (dims == 2) {
    uint h = jenkins(uvec2(corner.xy)) & 7u;
    float u = (h < 4u) ? d.x : d.y, v = 2.0 * ((h < 4u) ? d.y : d.x);
    return flip_if(u, h & 1u) + flip_if(v, h & 2u);
  }
  if (dims == 3) {
    uint h = jenkins(uvec3(corner.xyz)) & 15u;
    float u = (h < 8u) ? d.x : d.y;
    float v = (h < 4u) ? d.y : ((h == 12u || h == 14u) ? d.x : d.z);
    return flip_if(u, h & 1u) + flip_if(v, h & 2u);
  }
  uint h = jenkins(uvec4(corner)) & 31u;
  float u = (h < 24u) ? d.x : d.y, v = (h < 16u) ? d.y : d.z, s = (h < 8u) ? d.z : d.w;
  return flip_if(u, h & 1u) + flip_if(v, h & 2u) + flip_if(s, h & 4u);
}

// From -1 to 1.
float noise_signed(vec4 place, int dims)
{
  vec4 far = 0.5 * vec4(greaterThanEqual(abs(place), vec4(1000000.0)));
  place = place - NOISE_PERIOD * trunc(place / NOISE_PERIOD) + far;
  vec4 whole = floor(place), d = place - whole;
  ivec4 corner = ivec4(whole);
  vec4 t = d * d * d * (d * (d * 6.0 - 15.0) + 10.0);
  float sum = 0.0;
  // Corners of the cell, each with its weight.
  for (int i = 0; i < (1 << dims); i++) {
    ivec4 step = ivec4(i & 1, (i >> 1) & 1, (i >> 2) & 1, (i >> 3) & 1);
    vec4 weights = mix(1.0 - t, t, vec4(step));
    float weight = weights.x;
    weight *= (dims > 1) ? weights.y : 1.0;
    weight *= (dims > 2) ? weights.z : 1.0;
    weight *= (dims > 3) ? weights.w : 1.0;
    sum += weight * corner_slope(corner + step, d - vec4(step), dims);
  }
  float scale = (dims == 1) ? 0.25 : ((dims == 2) ? 0.6616 : ((dims == 3) ? 0.9820 : 0.8344));
  return scale * sum;
}

float noise_fbm(vec4 p, float detail, float roughness, float lacunarity, bool normalizes, int dims)
{
  float frequency = 1.0, amplitude = 1.0, largest = 0.0, sum = 0.0;
  for (int i = 0; i <= int(detail); i++) {
    sum += noise_signed(frequency * p, dims) * amplitude;
    largest += amplitude;
    amplitude *= roughness;
    frequency *= lacunarity;
  }
  float rest = detail - floor(detail);
  float value = normalizes ? 0.5 * sum / largest + 0.5 : sum;
  if (rest != 0.0) {
    float more = sum + noise_signed(frequency * p, dims) * amplitude;
    more = normalizes ? 0.5 * more / (largest + amplitude) + 0.5 : more;
    value = mix(value, more, rest);
  }
  return value;
}

float noise_multifractal(vec4 p, float detail, float roughness, float lacunarity, int dims)
{
  float value = 1.0, power = 1.0;
  for (int i = 0; i <= int(detail); i++) {
    value *= power * noise_signed(p, dims) + 1.0;
    power *= roughness;
    p *= lacunarity;
  }
  float rest = detail - floor(detail);
  return (rest != 0.0) ? value * (rest * power * noise_signed(p, dims) + 1.0) : value;
}

float noise_hetero_terrain(
    vec4 p, float detail, float roughness, float lacunarity, float offset, int dims)
{
  float power = roughness, value = offset + noise_signed(p, dims);
  p *= lacunarity;
  for (int i = 1; i <= int(detail); i++) {
    value += (noise_signed(p, dims) + offset) * power * value;
    power *= roughness;
    p *= lacunarity;
  }
  float rest = detail - floor(detail);
  return (rest != 0.0) ? value + rest * (noise_signed(p, dims) + offset) * power * value : value;
}

float noise_hybrid_multifractal(
    vec4 p, float detail, float roughness, float lacunarity, float offset, float gain, int dims)
{
  float power = 1.0, value = 0.0, weight = 1.0;
  for (int i = 0; i <= int(detail) && weight > 0.001; i++) {
    weight = min(weight, 1.0);
    float signal = (noise_signed(p, dims) + offset) * power;
    power *= roughness;
    value += weight * signal;
    weight *= gain * signal;
    p *= lacunarity;
  }
  float rest = detail - floor(detail);
  if (rest != 0.0 && weight > 0.001) {
    value += rest * min(weight, 1.0) * (noise_signed(p, dims) + offset) * power;
  }
  return value;
}

float noise_ridged_multifractal(
    vec4 p, float detail, float roughness, float lacunarity, float offset, float gain, int dims)
{
  float power = roughness, signal = offset - abs(noise_signed(p, dims));
  signal *= signal;
  float value = signal;
  for (int i = 1; i <= int(detail); i++) {
    p *= lacunarity;
    float weight = clamp(signal * gain, 0.0, 1.0);
    signal = offset - abs(noise_signed(p, dims));
    signal *= signal * weight;
    value += signal * power;
    power *= roughness;
  }
  return value;
}

// Offsets that make noises that have nothing to do with each other.
vec4 noise_offset(float seed, int dims)
{
  if (dims == 1) {
    return vec4(100.0 + 100.0 * random_of(seed), 0.0, 0.0, 0.0);
  }
  vec4 random = vec4(random_of(vec2(seed, 0.0)),
                     random_of(vec2(seed, 1.0)),
                     random_of(vec2(seed, 2.0)),
                     random_of(vec2(seed, 3.0)));
  return 100.0 + 100.0 * random;
}

struct NoiseLook {
  int type;
  int dims;
  bool normalizes;
  float detail;
  float roughness;
  float lacunarity;
  float offset;
  float gain;
};

float noise_value(vec4 p, NoiseLook n)
{
  if (n.type == NOISE_MULTIFRACTAL) {
    return noise_multifractal(p, n.detail, n.roughness, n.lacunarity, n.dims);
  }
  if (n.type == NOISE_HETERO_TERRAIN) {
    return noise_hetero_terrain(p, n.detail, n.roughness, n.lacunarity, n.offset, n.dims);
  }
  if (n.type == NOISE_HYBRID_MULTIFRACTAL) {
    return noise_hybrid_multifractal(
        p, n.detail, n.roughness, n.lacunarity, n.offset, n.gain, n.dims);
  }
  if (n.type == NOISE_RIDGED_MULTIFRACTAL) {
    return noise_ridged_multifractal(
        p, n.detail, n.roughness, n.lacunarity, n.offset, n.gain, n.dims);
  }
  return noise_fbm(p, n.detail, n.roughness, n.lacunarity, n.normalizes, n.dims);
}

vec4 noise_distorted(vec4 p, float distortion, int dims)
{
  vec4 moved = p;
  for (int i = 0; i < dims; i++) {
    moved[i] += distortion * noise_signed(p + noise_offset(float(i), dims), dims);
  }
  return moved;
}

// Value and colour; the colour's first channel is the value.
vec3 noise_texture(vec4 p, float distortion, NoiseLook n)
{
  n.detail = clamp(n.detail, 0.0, 15.0);
  n.roughness = max(n.roughness, 0.0);
  if (distortion != 0.0) {
    p = noise_distorted(p, distortion, n.dims);
  }
  // Colours begin with the seeds that distortion leaves.
  float first = float(n.dims);
  vec3 color = vec3(0.0);
  for (int i = 0; i < 3; i++) {
    vec4 place = (i == 0) ? p : p + noise_offset(first + float(i - 1), n.dims);
    color[i] = noise_value(place, n);
  }
  return color;
}

float noise_texture_value(vec4 p, float distortion, NoiseLook n)
{
  n.detail = clamp(n.detail, 0.0, 15.0);
  n.roughness = max(n.roughness, 0.0);
  if (distortion != 0.0) {
    p = noise_distorted(p, distortion, n.dims);
  }
  return noise_value(p, n);
}

#endif
