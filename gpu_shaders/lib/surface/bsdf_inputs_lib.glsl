// Parameters of a closure that reflects light, of any kind: generated code fills one for each such
// node, and `closure_lit` evaluates them one after the other.
#ifndef BSDF_INPUTS_LIB_GLSL
#define BSDF_INPUTS_LIB_GLSL

#define BSDF_DIFFUSE 0
#define BSDF_GLOSSY 1
#define BSDF_PRINCIPLED 2

struct Bsdf {
  int kind;
  vec3 color;
  vec3 normal;  // in world space, on the side that is seen; 0 for the surface's own
  float roughness;
  bool repeats;  // scattering more than once between the facets is added
  float metallic;
  float ior;
  float specular_level;
  vec3 specular_tint;
  vec3 emission_color;
  float emission_strength;
};

Bsdf bsdf_of_kind(int kind)
{
  return Bsdf(kind, vec3(0.0), vec3(0.0), 0.0, true, 0.0, 1.5, 0.5, vec3(1.0), vec3(0.0), 0.0);
}

#endif
