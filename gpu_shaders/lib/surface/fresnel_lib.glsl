// Reflectance of smooth dielectrics.
#ifndef FRESNEL_LIB_GLSL
#define FRESNEL_LIB_GLSL

// Unpolarised reflectance of a dielectric of relative index `eta`.
float fresnel_dielectric(float cosine, float eta)
{
  float c = abs(cosine);
  float g = eta * eta - 1.0 + c * c;
  if (g <= 0.0) {
    return 1.0;
  }
  g = sqrt(g);
  float a = (g - c) / (g + c);
  float b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
  return 0.5 * a * a * (1.0 + b * b);
}

#endif
