// Microfacet reflection: GGX with height-correlated Smith masking, as in Cycles.
// Walter et al., EGSR 2007; Heitz, JCGT 3(2), 2014.
#ifndef BSDF_LIB_GLSL
#define BSDF_LIB_GLSL
#include "lib/surface/fresnel_lib.glsl"

#define PI 3.14159265358979

// Distribution of normals; alpha is roughness squared.
float ggx_distribution(float cos_h, float alpha)
{
  float a2 = alpha * alpha;
  float t = (cos_h * a2 - cos_h) * cos_h + 1.0;
  return a2 / (PI * t * t);
}

// Mean of the distribution over a disk of half vectors of radius `reach` around one whose cosine to
// the normal is `cos_h`; sizes are tangents. **Ours**, exact in the plane of slopes: there GGX is
// the stereographic image of a uniform sphere, on which a disk is a cap.
float ggx_distribution_over_disk(float cos_h, float reach, float alpha)
{
  float cos2 = max(cos_h * cos_h, 1e-6);
  float slope2 = max(1.0 / cos2 - 1.0, 0.0);
  float t = max(reach, 1e-3 * alpha);
  float cap = 0.5 * atan(2.0 * t * alpha, alpha * alpha + slope2 - t * t);
  float mass = sin(cap);
  return mass * mass / (PI * t * t * cos2 * cos2);
}

// Masking and shadowing over 4 cos_view cos_light.
float ggx_visibility(float cos_view, float cos_light, float alpha)
{
  float a2 = alpha * alpha;
  float v = cos_light * sqrt((cos_view - a2 * cos_view) * cos_view + a2);
  float l = cos_view * sqrt((cos_light - a2 * cos_light) * cos_light + a2);
  return 0.5 / max(v + l, 1e-7);
}

// Masking of the view by the facets.
float ggx_masking(float cosine, float alpha)
{
  float c2 = max(cosine * cosine, 1e-8);
  return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * (1.0 / c2 - 1.0)));
}

// A facet's normal as the view sees them, in a frame whose z axis is the surface's normal.
// Heitz, Sampling the GGX distribution of visible normals, JCGT 7(4), 2018.
vec3 ggx_visible_normal(vec3 view, float alpha, vec2 u)
{
  vec3 v = normalize(vec3(alpha * view.xy, view.z));
  float across = dot(v.xy, v.xy);
  vec3 t1 = (across > 1e-12) ? vec3(-v.y, v.x, 0.0) * inversesqrt(across) : vec3(1.0, 0.0, 0.0);
  vec3 t2 = cross(v, t1);
  float radius = sqrt(u.x);
  float p1 = radius * cos(2.0 * PI * u.y);
  float lift = 0.5 * (1.0 + v.z);
  float p2 = mix(sqrt(max(1.0 - p1 * p1, 0.0)), radius * sin(2.0 * PI * u.y), lift);
  vec3 h = p1 * t1 + p2 * t2 + sqrt(max(1.0 - p1 * p1 - p2 * p2, 0.0)) * v;
  return normalize(vec3(alpha * h.xy, max(h.z, 1e-6)));
}

float fresnel_schlick(float cosine)
{
  float m = 1.0 - clamp(cosine, 0.0, 1.0);
  float m2 = m * m;
  return m2 * m2 * m;
}

float f0_from_ior(float ior)
{
  float r = (ior - 1.0) / (ior + 1.0);
  return r * r;
}

float ior_from_f0(float f0)
{
  float r = sqrt(clamp(f0, 0.0, 0.99));
  return (1.0 + r) / (1.0 - r);
}

// Fresnel reflectance of a dielectric, scaled to 0 at normal incidence and 1 at grazing incidence.
float fresnel_dielectric_rise(float cosine, float eta)
{
  float f0 = f0_from_ior(eta);
  return clamp((fresnel_dielectric(cosine, eta) - f0) / max(1.0 - f0, 1e-6), 0.0, 1.0);
}

// Directional albedo of a lobe F = f0 + (1 - f0) rise: xy are the shares of f0 and of the rise, z is
// the mean of x + y over the hemisphere. Table over cosine and roughness, see ggx_table of
// addon/passes/surface/environment.py.
vec3 ggx_albedo(sampler2D ggx_tx, float cos_view, float roughness)
{
  vec2 size = vec2(textureSize(ggx_tx, 0));
  vec2 place = clamp(vec2(sqrt(clamp(cos_view, 0.0, 1.0)), roughness), 0.0, 1.0);
  return texture(ggx_tx, (place * (size - 1.0) + 0.5) / size).xyz;
}

// What multiple scattering adds to a lobe, as a factor. `mean_fresnel` is over the hemisphere.
// Kulla and Conty, Revisiting physically based shading at Imageworks, 2017.
vec3 ggx_multiple_scattering(vec3 albedo, vec3 mean_fresnel)
{
  float missing = (1.0 - (albedo.x + albedo.y)) / max(albedo.x + albedo.y, 1e-4);
  vec3 repeated = mean_fresnel * albedo.z / max(1.0 - mean_fresnel * (1.0 - albedo.z), vec3(1e-4));
  return 1.0 + repeated * max(missing, 0.0);
}

#endif
