// Parameters of a closure that reflects light, of any kind: generated code fills one for each such
// node, and `closure_lit` evaluates them one after the other.
#ifndef BSDF_INPUTS_LIB_GLSL
#define BSDF_INPUTS_LIB_GLSL

#define BSDF_DIFFUSE 0
#define BSDF_GLOSSY 1
#define BSDF_PRINCIPLED 2
#define BSDF_TRANSLUCENT 3
#define BSDF_METALLIC 4
#define BSDF_GLASS 5
#define BSDF_FOG 6
#include "lib/surface/shapes_lib.glsl"

struct Bsdf {
  int kind;
  vec3 color;
  vec3 normal;  // in world space, on the side that is seen; 0 for the surface's own
  float roughness;
  bool repeats;  // scattering more than once between the facets is added
  float metallic;
  float ior;
  float specular_level;
  vec3 specular_tint;  // metals: the tint of the edge
  vec3 emission_color;
  float emission_strength;
  float transmission;  // share of the base that is glass
  float coat;          // share that is coated
  float coat_roughness;
  float coat_ior;
  vec3 coat_tint;
  vec3 coat_normal;    // 0 for the normal below
  float sheen;         // share that has fibres on top
  float sheen_roughness;
  vec3 sheen_tint;
  Shape shape;         // of the diffuse part
  vec3 extinction;     // fog: light lost in a metre; its colour is what is scattered of it
  float thickness;     // fog: m
};

Bsdf bsdf_of_kind(int kind)
{
  Bsdf bsdf;
  bsdf.kind = kind;
  bsdf.color = vec3(0.0);
  bsdf.normal = vec3(0.0);
  bsdf.roughness = 0.0;
  bsdf.repeats = true;
  bsdf.metallic = 0.0;
  bsdf.ior = 1.5;
  bsdf.specular_level = 0.5;
  bsdf.specular_tint = vec3(1.0);
  bsdf.emission_color = vec3(0.0);
  bsdf.emission_strength = 0.0;
  bsdf.transmission = 0.0;
  bsdf.coat = 0.0;
  bsdf.coat_roughness = 0.03;
  bsdf.coat_ior = 1.5;
  bsdf.coat_tint = vec3(1.0);
  bsdf.coat_normal = vec3(0.0);
  bsdf.sheen = 0.0;
  bsdf.sheen_roughness = 0.5;
  bsdf.sheen_tint = vec3(1.0);
  bsdf.shape = Shape(SHAPE_LAMBERT, vec4(0.0), vec3(0.0));
  bsdf.extinction = vec3(0.0);
  bsdf.thickness = 0.0;
  return bsdf;
}

#endif
