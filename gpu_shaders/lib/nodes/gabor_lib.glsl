// Gabor noise with Blender's own numbers: waves under bells at random places of each cell of a lattice.
// Lagae et al., Procedural noise using sparse Gabor convolution, SIGGRAPH 2009; as phasors: Tavernier
// et al., Making Gabor noise fast and normalized, Eurographics 2019.
#ifndef GABOR_LIB_GLSL
#define GABOR_LIB_GLSL
#include "lib/nodes/random_lib.glsl"

#define GABOR_PI 3.14159265358979
// Waves in a cell.
#define GABOR_WAVES 8

// A wave under a bell that ends at distance 1, as a phasor.
vec2 gabor_wave(float distance2, float angle)
{
  float bell = exp(-GABOR_PI * distance2) * (0.5 + 0.5 * cos(GABOR_PI * distance2));
  return bell * vec2(cos(angle), sin(angle));
}

// Value, phase and intensity of a sum of waves, whose variance is that of `energy` of one wave.
vec3 gabor_shown(vec2 sum, float energy)
{
  vec2 scaled = sum / (6.0 * sqrt(float(GABOR_WAVES) * 0.5 * energy));
  float phase = (sum == vec2(0.0)) ? 0.0 : atan(sum.y, sum.x);
  return vec3(0.5 * scaled.y + 0.5, (phase + GABOR_PI) / (2.0 * GABOR_PI), length(scaled));
}

vec3 gabor_flat(vec2 place, float frequency, float anisotropy, float orientation)
{
  float isotropy = 1.0 - clamp(anisotropy, 0.0, 1.0);
  frequency = max(frequency, 0.001);
  vec2 corner = floor(place), local = place - corner, sum = vec2(0.0);
  for (int n = 0; n < 9; n++) {
    vec2 step = vec2(n / 3 - 1, n % 3 - 1), cell = corner + step;
    for (int i = 0; i < GABOR_WAVES; i++) {
      vec3 seed = vec3(cell, float(3 * i));
      float turned = (random_of(seed) - 0.5) * GABOR_PI * isotropy + orientation;
      vec3 k = vec3(cell, float(3 * i + 1));
      vec2 d = local - step - vec2(random_of(k), random_of(k.zxy));
      float distance2 = dot(d, d);
      if (distance2 >= 1.0) {
        continue;
      }
      float weight = (random_of(vec3(cell, float(3 * i + 2))) < 0.5) ? -1.0 : 1.0;
      float along = dot(d, frequency * vec2(cos(turned), sin(turned)));
      sum += weight * gabor_wave(distance2, 2.0 * GABOR_PI * along);
    }
  }
  return gabor_shown(sum, 0.25);
}

vec3 gabor_direction(vec3 orientation, float isotropy, vec4 seed)
{
  if (isotropy == 0.0) {
    return orientation;
  }
  float inclination = acos(clamp(orientation.z, -1.0, 1.0));
  float across = length(orientation.xy);
  float azimuth = (across > 0.0) ?
                      sign(orientation.y) * acos(clamp(orientation.x / across, -1.0, 1.0)) :
                      0.0;
  vec2 random = vec2(random_of(seed), random_of(seed.zxwy)) * GABOR_PI;
  inclination += random.x * isotropy;
  azimuth += random.y * isotropy;
  return vec3(sin(inclination) * cos(azimuth), sin(inclination) * sin(azimuth), cos(inclination));
}

vec3 gabor_solid(vec3 place, float frequency, float anisotropy, vec3 orientation)
{
  float isotropy = 1.0 - clamp(anisotropy, 0.0, 1.0);
  frequency = max(frequency, 0.001);
  float size = length(orientation);
  vec3 base = (size > 0.0) ? orientation / size : orientation;
  vec3 corner = floor(place), local = place - corner;
  vec2 sum = vec2(0.0);
  for (int n = 0; n < 27; n++) {
    vec3 step = vec3(n / 9 - 1, (n / 3) % 3 - 1, n % 3 - 1), cell = corner + step;
    for (int i = 0; i < GABOR_WAVES; i++) {
      vec3 direction = gabor_direction(base, isotropy, vec4(cell, float(3 * i)));
      vec4 k = vec4(cell, float(3 * i + 1));
      vec3 d = local - step - vec3(random_of(k), random_of(k.zxwy), random_of(k.wzyx));
      float distance2 = dot(d, d);
      if (distance2 >= 1.0) {
        continue;
      }
      float weight = (random_of(vec4(cell, float(3 * i + 2))) < 0.5) ? -1.0 : 1.0;
      float along = dot(d, frequency * direction);
      sum += weight * gabor_wave(distance2, 2.0 * GABOR_PI * along);
    }
  }
  return gabor_shown(sum, 0.25 / sqrt(2.0));
}

#endif
