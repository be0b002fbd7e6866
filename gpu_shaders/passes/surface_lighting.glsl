// Closures that meet light: what a surface reflects of lights (without shadows) and of the world.
// Included into shaders that draw surfaces. Without SHADES only what a surface lets through counts,
// and no light is read.
// Inputs: world_position, world_normal where the mesh has normals; view_buf, lens_sample;
// lights_tx (light table); environment_buf, environment_tx (image), environment_levels_tx
// (prefiltered), ggx_tx (albedo table).
// Source: split-sum environment, Karis, SIGGRAPH 2013 course; closures as Cycles composes them.
#include "lib/closure_lib.glsl"

#if defined(LIT) && defined(SHADES)
#include "lib/bsdf_lib.glsl"
#include "lib/environment_lib.glsl"
#include "lib/light_lib.glsl"
#include "lib/texture_lib.glsl"

// Mirrors are drawn this rough under lights, so that their highlights have a finite size.
#define MIN_ALPHA 2e-4

struct Shading {
  vec3 position;
  vec3 normal;  // shading normal on the side that is seen
  vec3 view;    // towards the lens sample
  float cos_view;
};

// A reflecting lobe: F = f0 + (1 - f0) rise. eta > 0: a dielectric's rise, else Schlick's.
struct Lobe {
  vec3 weight;
  vec3 f0;
  float eta;
  bool repeats;  // light scattered more than once between the facets is added
};

Shading surface_shading()
{
  Shading s;
  s.position = world_position;
  vec3 view = (view_buf.lens.y > 0.5) ? vec3(lens_sample.xy / view_buf.lens.x, 1.0) :
                                        vec3(lens_sample.xy, 0.0);
  if (view_buf.lens.y > 0.5) {
    s.view = normalize(mat3(view_buf.view_inverse) * view);
  }
  else {
    s.view = normalize((view_buf.view_inverse * vec4(view, 1.0)).xyz - world_position);
  }
  // The side that is seen is a property of the triangle, not of its interpolated normal.
  vec3 geometric = cross(dFdx(world_position), dFdy(world_position));
  geometric = (dot(geometric, s.view) < 0.0) ? -geometric : geometric;
#ifdef HAS_NORMAL
  vec3 normal = (dot(world_normal, geometric) < 0.0) ? -world_normal : world_normal;
#else
  vec3 normal = geometric;
#endif
  float size = length(normal);
  s.normal = (size > 0.0) ? normal / size : s.view;
  s.cos_view = clamp(dot(s.normal, s.view), 1e-4, 1.0);
  return s;
}

vec3 environment_direction(vec3 direction)
{
  return vec3(dot(environment_buf.rotation_x.xyz, direction),
              dot(environment_buf.rotation_y.xyz, direction),
              dot(environment_buf.rotation_z.xyz, direction));
}

// Radiance of a white Lambertian surface.
vec3 diffuse_light(Shading s)
{
  vec3 sum = environment_buf.color.rgb;
  if (environment_buf.color.w > 0.5) {
    sum *= environment_diffuse(environment_buf.harmonics, environment_direction(s.normal));
  }
  for (int i = 0; i < light_count(lights_tx); i++) {
    Light light = light_fetch(lights_tx, i);
    if (light.kind == LIGHT_NONE) {
      continue;
    }
    Illumination incoming = light_illuminate(light, s.position);
    float cosine = horizon_cosine(dot(s.normal, incoming.towards), incoming.sin2);
    sum += incoming.irradiance * (light.factors.x * cosine / PI);
  }
  return sum;
}

// Mean of the world over a lobe around the mirrored direction.
vec3 environment_glossy(Shading s, float roughness)
{
  if (environment_buf.color.w < 0.5) {
    return environment_buf.color.rgb;
  }
  vec3 mirrored = 2.0 * dot(s.normal, s.view) * s.normal - s.view;
  // The lobe of a rough surface leans from the mirrored direction towards the normal.
  // Lagarde and de Rousiers, Moving Frostbite to physically based rendering, 2014.
  float smoothness = 1.0 - roughness;
  float lean = smoothness * (sqrt(smoothness) + roughness);
  vec3 direction = environment_direction(normalize(mix(s.normal, mirrored, lean)));
  vec2 place = direction_to_octahedron(direction);
  float level = clamp(roughness, 0.0, 1.0) * float(ENVIRONMENT_LEVELS) - 1.0;
  vec3 radiance;
  if (level < 0.0) {
    vec3 sharp =
        image_linear(environment_tx, direction_to_equirect(direction), EXTENSION_REPEAT).rgb;
    radiance = mix(sharp, environment_level(environment_levels_tx, place, 0.0), level + 1.0);
  }
  else {
    float lower = min(floor(level), float(ENVIRONMENT_LEVELS - 2));
    radiance = mix(environment_level(environment_levels_tx, place, lower),
                   environment_level(environment_levels_tx, place, lower + 1.0),
                   level - lower);
  }
  return radiance * environment_buf.color.rgb;
}

// What a lobe reflects of white surroundings.
vec3 lobe_albedo(Lobe lobe, vec3 albedo)
{
  vec3 single = lobe.f0 * albedo.x + albedo.y;
  if (!lobe.repeats) {
    return single;
  }
  return single * ggx_multiple_scattering(albedo, lobe.f0 + (1.0 - lobe.f0) / 21.0);
}

// Light reflected by two lobes of one roughness.
vec3 glossy_light(Shading s, float roughness, Lobe a, Lobe b)
{
  vec3 albedo = ggx_albedo(ggx_tx, s.cos_view, roughness);
  vec3 sum = environment_glossy(s, roughness) *
             (a.weight * lobe_albedo(a, albedo) + b.weight * lobe_albedo(b, albedo));
  vec3 repeat_a = a.repeats ? ggx_multiple_scattering(albedo, a.f0 + (1.0 - a.f0) / 21.0) :
                              vec3(1.0);
  vec3 repeat_b = b.repeats ? ggx_multiple_scattering(albedo, b.f0 + (1.0 - b.f0) / 21.0) :
                              vec3(1.0);
  float alpha = max(roughness * roughness, MIN_ALPHA);
  vec3 mirrored = 2.0 * dot(s.normal, s.view) * s.normal - s.view;
  for (int i = 0; i < light_count(lights_tx); i++) {
    Light light = light_fetch(lights_tx, i);
    if (light.kind == LIGHT_NONE) {
      continue;
    }
    Illumination incoming = light_illuminate(light, s.position);
    // Half vectors of the light's disk fill half its angle, more across the plane of incidence.
    float cos_d = dot(s.view, normalize(incoming.towards + s.view));
    float reach = sqrt(incoming.sin2) / (1.0 + sqrt(1.0 - incoming.sin2)) *
                  inversesqrt(max(cos_d, 0.05));
    // A lobe narrower than the light sees the part of it that a mirror would show, a wide one all.
    float narrow = reach * reach / (reach * reach + alpha * alpha);
    vec3 shown = light_representative(light, incoming, s.position, mirrored);
    float cos_light = mix(horizon_cosine(dot(s.normal, incoming.towards), incoming.sin2),
                          max(dot(s.normal, shown), 0.0),
                          narrow);
    if (cos_light <= 0.0) {
      continue;
    }
    cos_d = dot(s.view, normalize(mix(incoming.towards, shown, narrow) + s.view));
    cos_d = clamp(cos_d, 0.0, 1.0);
    float cos_h = clamp(dot(s.normal, normalize(incoming.towards + s.view)), 0.0, 1.0);
    float lobe = ggx_distribution_over_disk(cos_h, reach, alpha) *
                 ggx_visibility(s.cos_view, cos_light, alpha) * cos_light;
    float rise_a = (a.eta > 0.0) ? fresnel_dielectric_rise(cos_d, a.eta) : fresnel_schlick(cos_d);
    float rise_b = (b.eta > 0.0) ? fresnel_dielectric_rise(cos_d, b.eta) : fresnel_schlick(cos_d);
    vec3 reflected = a.weight * repeat_a * mix(a.f0, vec3(1.0), rise_a) +
                     b.weight * repeat_b * mix(b.f0, vec3(1.0), rise_b);
    sum += incoming.irradiance * (light.factors.y * lobe) * reflected;
  }
  return sum;
}

Closure closure_diffuse(vec3 color)
{
  return Closure(color * diffuse_light(surface_shading()), vec3(0.0), 0.0);
}

Closure closure_glossy(vec3 color, float roughness, bool repeats)
{
  Shading s = surface_shading();
  float r = clamp(roughness, 0.0, 1.0);
  vec3 albedo = ggx_albedo(ggx_tx, s.cos_view, r);
  vec3 c = max(color, vec3(0.0));
  // The same reflectance in every direction: a lobe of f0 = 1, with the colour as its weight.
  vec3 repeat_color = repeats ? ggx_multiple_scattering(albedo, clamp(c, 0.0, 1.0)) : vec3(1.0);
  Lobe lobe = Lobe(c * repeat_color, vec3(1.0), 0.0, false);
  Lobe none = Lobe(vec3(0.0), vec3(0.0), 0.0, false);
  return Closure(glossy_light(s, r, lobe, none), vec3(0.0), 0.0);
}

Closure closure_principled(vec3 base_color,
                           float metallic,
                           float roughness,
                           float ior,
                           float specular_level,
                           vec3 specular_tint,
                           vec3 emission_color,
                           float emission_strength)
{
  Shading s = surface_shading();
  vec3 base = clamp(base_color, 0.0, 1.0);
  float metal = clamp(metallic, 0.0, 1.0);
  float r = clamp(roughness, 0.0, 1.0);
  vec3 tint = max(specular_tint, vec3(0.0));
  float eta = max(ior, 1e-5);
  float f0 = f0_from_ior(eta);
  if (specular_level != 0.5) {
    f0 *= 2.0 * max(specular_level, 0.0);
    float raised = ior_from_f0(f0);
    eta = (eta < 1.0) ? 1.0 / raised : raised;
    f0 = f0_from_ior(eta);
  }
  vec3 albedo = ggx_albedo(ggx_tx, s.cos_view, r);
  Lobe metal_lobe = Lobe(vec3(metal), base, 0.0, true);
  Lobe dielectric = Lobe(vec3(1.0 - metal), clamp(f0 * tint, 0.0, 1.0), eta, true);
  vec3 light = glossy_light(s, r, metal_lobe, dielectric);
  if (metal < 1.0) {
    // The diffuse layer gets what the coat of the dielectric does not reflect.
    vec3 taken = lobe_albedo(dielectric, albedo);
    float left = (1.0 - metal) * clamp(1.0 - max(taken.r, max(taken.g, taken.b)), 0.0, 1.0);
    light += base * left * diffuse_light(s);
  }
  return Closure(light + emission_color * emission_strength, vec3(0.0), 0.0);
}

#else

Closure closure_diffuse(vec3 color)
{
  return closure_none();
}

Closure closure_glossy(vec3 color, float roughness, bool repeats)
{
  return closure_none();
}

Closure closure_principled(vec3 base_color,
                           float metallic,
                           float roughness,
                           float ior,
                           float specular_level,
                           vec3 specular_tint,
                           vec3 emission_color,
                           float emission_strength)
{
  return closure_none();
}

#endif
