// Colour encodings.
#ifndef COLOR_LIB_GLSL
#define COLOR_LIB_GLSL

// IEC 61966-2-1 decoding.
vec3 srgb_to_linear(vec3 encoded)
{
  vec3 high = pow((max(encoded, vec3(0.0)) + 0.055) / 1.055, vec3(2.4));
  return mix(high, encoded / 12.92, lessThan(encoded, vec3(0.04045)));
}

#endif
