// Lighting of closures: reflection of lights and of the world, each as much as arrives of it.
// Included into shaders that draw surfaces. Without SHADES only the transmittance is computed, and no
// light is read.
// Inputs: world_position, world_normal where the mesh has normals; view_buf, lens_sample (OF_LAYER: eye);
// lights_tx (light table), light_maps_tx, lit_by_tx (light samples), slack;
// environment_buf, environment_tx (image), environment_levels_tx
// (prefiltered), ggx_tx (albedo table).
// Source: split-sum environment, Karis, SIGGRAPH 2013 course; closures as Cycles composes them.
// Outside of conditions: nodes call these, too, and a file is included once.
#include "lib/nodes/point_lib.glsl"
#include "lib/surface/bsdf_inputs_lib.glsl"
#include "lib/surface/closure_lib.glsl"
#include "lib/surface/fresnel_lib.glsl"

// Share of the light that passes fog.
vec3 fog_transmittance(Bsdf bsdf)
{
  return exp(-max(number_or_zero(bsdf.extinction), vec3(0.0)) * bsdf.thickness);
}

// Share of the light that passes a face of glass.
vec3 glass_transmittance(Bsdf bsdf, float cos_view)
{
  vec3 color = clamp(number_or_zero(bsdf.color), 0.0, 1.0);
  float eta = clamp(number_or_zero(bsdf.ior), 1e-5, 1e5);
  float mirrored = (bsdf.specular_level > 0.0) ? fresnel_dielectric(cos_view, eta) : 0.0;
  return color * (1.0 - mirrored);
}

#if defined(LIT) && defined(SHADES)
#include "lib/surface/bsdf_lib.glsl"
#include "lib/surface/environment_lib.glsl"
#include "lib/surface/light_lib.glsl"
#include "lib/surface/light_map_lib.glsl"
#include "lib/surface/texture_lib.glsl"

// Least roughness under lights, so that the highlights of mirrors have a finite size.
#define MIN_ALPHA 2e-4

// Below this roughness one prefiltered look-up along the lobe's axis is enough.
#define SPLIT_ROUGHNESS 0.15
#define FACETS 6
#define FACET_OVERLAP 1.0
#define GOLDEN_RATIO 0.61803399

struct Shading {
  vec3 position;
  vec3 geometric;  // normal of the triangle, of any length
  vec3 normal;  // shading normal on the side that is seen
  vec3 view;    // towards the lens sample
  float cos_view;
#ifdef SHAPES
  Shape shape;  // of diffuse light
#endif
};

// A reflecting lobe: F = f0 + (1 - f0) rise - dip cos (1 - cos)^6. eta > 0: a dielectric's rise, else
// Schlick's. The dip is what the edge of a metal lacks (F82; Kutz et al., 2021).
struct Lobe {
  vec3 weight;
  vec3 f0;
  float eta;
  bool repeats;  // multiple scattering between the facets is added
  vec3 dip;
};

// Light that a surface reflects towards the eye.
struct Reflected {
  vec3 light;
  vec3 unsplit;  // part of it that is never splatted (of lamps without highlights)
  vec3 shift;    // see Closure
};

// `bent`: a normal that nodes have made, 0 for the surface's own.
Shading surface_shading(vec3 bent)
{
  Shading s;
  s.position = world_position;
  s.view = point_view();
  // The side that is seen is a property of the triangle, not of its interpolated normal.
  s.geometric = point_geometric_normal(s.view);
  vec3 normal = point_smooth_normal(s.geometric);
  normal = (dot(bent, bent) > 0.0) ? bent : normal;
  float size = length(normal);
  s.normal = (size > 0.0) ? normal / size : s.view;
  s.cos_view = clamp(dot(s.normal, s.view), 1e-4, 1.0);
#ifdef SHAPES
  s.shape = Shape(SHAPE_LAMBERT, vec4(0.0), vec3(0.0));
#endif
  return s;
}

vec3 environment_direction(vec3 direction)
{
  return vec3(dot(environment_buf.rotation_x.xyz, direction),
              dot(environment_buf.rotation_y.xyz, direction),
              dot(environment_buf.rotation_z.xyz, direction));
}

// A lamp's light that a white surface of the shape reflects, over its irradiance.
float diffuse_response(Shading s, vec3 towards, float sin2)
{
#ifdef SHAPES
  if (s.shape.kind != SHAPE_LAMBERT) {
    return shape_response(s.shape, s.normal, s.view, towards);
  }
#endif
  return horizon_cosine(dot(s.normal, towards), sin2) / PI;
}

// The normal of a Lambertian surface that reflects the world as the shape does, in proportion.
vec3 diffuse_axis(Shading s)
{
  vec3 axis = s.normal;
#ifdef SHAPES
  if (s.shape.kind != SHAPE_LAMBERT) {
    axis = (s.shape.kind == SHAPE_HAIR_THROUGH) ? -axis : axis;
    axis = (s.shape.kind == SHAPE_TOON_GLOSSY) ? 2.0 * dot(axis, s.view) * axis - s.view : axis;
  }
#endif
  return axis;
}

// How much of the world's light a white surface of the shape reflects, over a Lambertian one.
vec3 diffuse_share(Shading s)
{
#ifdef SHAPES
  if (s.shape.kind != SHAPE_LAMBERT) {
    return vec3(shape_albedo(s.shape, s.cos_view));
  }
#endif
  return vec3(1.0);
}

// The world's light on a white Lambertian surface.
vec3 environment_diffuse(vec3 normal)
{
  if (environment_buf.color.w < 0.5) {
    return environment_buf.color.rgb;
  }
  vec2 place = direction_to_octahedron(environment_direction(normal));
  return environment_buf.color.rgb *
         environment_level(environment_levels_tx, place, ENVIRONMENT_DIFFUSE);
}

#include "passes/surface/surface_shadows.glsl"

// What arrives of the light on a white surface, by the light samples of a list; `lit`: if nothing hid it.
Reflected arriving_diffuse(Shading s, int list, vec3 of_sky, out vec3 lit)
{
  lit = of_sky;
  Reflected sum = Reflected(of_sky * sky_share(s, list, diffuse_axis(s)), vec3(0.0), vec3(0.0));
  for (int i = 0; i < light_count(lights_tx); i++) {
    Light light = light_fetch(lights_tx, i);
    if (light.kind == LIGHT_NONE) {
      continue;
    }
    vec3 reflected = lamp_diffuse(s, light, light_illuminate(light, s.position));
    lit += reflected;
    if (reflected != vec3(0.0)) {
      reflected *= lamp_share(s, list, i, light);
      sum.light += reflected;
      sum.unsplit += reflected * light.unsplit;
    }
  }
  return sum;
}

// Of a white surface.
Reflected diffuse_light(Shading s)
{
  vec3 of_sky = diffuse_share(s) * environment_diffuse(diffuse_axis(s));
  vec3 lit;
  Reflected own = arriving_diffuse(s, OWN, of_sky, lit);
  if (light_is_steady(max(own.light, lit))) {
    Reflected steady = arriving_diffuse(s, STEADY, of_sky, lit);
    steady.shift = own.light - steady.light;
    return steady;
  }
  return own;
}

// The world in a direction, averaged over a lobe of a roughness.
vec3 environment_radiance(vec3 direction, float roughness)
{
  vec3 local = environment_direction(direction);
  vec2 place = direction_to_octahedron(local);
  float level = clamp(roughness, 0.0, 1.0) * float(ENVIRONMENT_LEVELS) - 1.0;
  if (level < 0.0) {
    vec3 sharp = image_linear(environment_tx, direction_to_equirect(local), EXTENSION_REPEAT).rgb;
    return mix(sharp, environment_level(environment_levels_tx, place, 0.0), level + 1.0);
  }
  float lower = min(floor(level), float(ENVIRONMENT_LEVELS - 2));
  return mix(environment_level(environment_levels_tx, place, lower),
             environment_level(environment_levels_tx, place, lower + 1.0),
             level - lower);
}

#ifdef REFRACTS
#include "passes/surface/surface_refraction.glsl"
#endif

float lobe_rise(Lobe lobe, float cosine)
{
  return (lobe.eta > 0.0) ? fresnel_dielectric_rise(cosine, lobe.eta) : fresnel_schlick(cosine);
}

vec3 lobe_repeat(Lobe lobe, vec3 albedo)
{
  return lobe.repeats ? ggx_multiple_scattering(albedo, lobe.f0 + (1.0 - lobe.f0) / 21.0) :
                        vec3(1.0);
}

vec3 lobe_fresnel(Lobe lobe, float cosine)
{
  float m = 1.0 - clamp(cosine, 0.0, 1.0);
  return mix(lobe.f0, vec3(1.0), lobe_rise(lobe, cosine)) -
         lobe.dip * (clamp(cosine, 0.0, 1.0) * m * m * m * m * m * m);
}

// Directional albedo of a lobe.
vec3 lobe_albedo(Lobe lobe, vec3 albedo, float cos_view)
{
  // The dip is that of a mirror: the table has none.
  float m = 1.0 - cos_view;
  vec3 lacks = lobe.dip * (cos_view * m * m * m * m * m * m * (albedo.x + albedo.y));
  return (lobe.f0 * albedo.x + albedo.y - lacks) * lobe_repeat(lobe, albedo);
}

// Reflectance of two lobes at a facet.
vec3 lobes_reflect(Lobe a, vec3 repeat_a, Lobe b, vec3 repeat_b, float cosine)
{
  return a.weight * repeat_a * lobe_fresnel(a, cosine) +
         b.weight * repeat_b * lobe_fresnel(b, cosine);
}

// The world reflected by two lobes, by a few sampled facets, each with the world averaged over its
// share of the lobe. All pixels of a lens sample use the same facets, so that there is no noise between
// pixels; other samples use others.
vec3 environment_reflection(Shading s, float roughness, Lobe a, vec3 repeat_a, Lobe b, vec3 repeat_b)
{
  float alpha = roughness * roughness;
  vec3 up = (abs(s.normal.z) < 0.9) ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
  vec3 tangent = normalize(cross(up, s.normal));
  vec3 bitangent = cross(s.normal, tangent);
  vec3 view = vec3(dot(s.view, tangent), dot(s.view, bitangent), s.cos_view);
  uint seed = hash_combine(floatBitsToUint(lens_sample.z), floatBitsToUint(lens_sample.w));
  vec2 shift = vec2(hash_unit(seed), hash_unit(hash_uint(seed)));
  float masking = ggx_masking(view.z, alpha);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < FACETS; i++) {
    vec2 u = vec2((float(i) + shift.x) / float(FACETS), fract(float(i) * GOLDEN_RATIO + shift.y));
    vec3 h = ggx_visible_normal(view, alpha, u);
    float cos_d = clamp(dot(view, h), 0.0, 1.0);
    vec3 light = 2.0 * cos_d * h - view;
    if (light.z <= 0.0) {
      continue;
    }
    // Solid angle of the facet's share, as the roughness of a lobe of that size.
    float density = ggx_distribution(h.z, alpha) * masking / (4.0 * view.z);
    float share = 1.0 / (4.0 * PI * float(FACETS) * max(density, 1e-6));
    float level = min(sqrt(sqrt(FACET_OVERLAP * share)), roughness);
    float passed = ggx_visibility(view.z, light.z, alpha) * 4.0 * view.z * light.z / masking;
    vec3 direction = tangent * light.x + bitangent * light.y + s.normal * light.z;
    sum += environment_radiance(direction, level) * passed *
           lobes_reflect(a, repeat_a, b, repeat_b, cos_d);
  }
  return sum * environment_buf.color.rgb / float(FACETS);
}

// Two lobes of one roughness.
struct Lobes {
  float alpha;
  vec3 mirrored;
  Lobe a;
  vec3 repeat_a;
  Lobe b;
  vec3 repeat_b;
};

// Reflected by two lobes, of one lamp.
vec3 lamp_glossy(Shading s, Light light, Lobes lobes)
{
  float alpha = lobes.alpha;
  Illumination incoming = light_illuminate(light, s.position);
  // Half vectors of the light's disk subtend half its angle, more across the plane of incidence.
  float cos_d = dot(s.view, normalize(incoming.towards + s.view));
  float reach = sqrt(incoming.sin2) / (1.0 + sqrt(1.0 - incoming.sin2)) *
                inversesqrt(max(cos_d, 0.05));
  // A lobe narrower than the light reflects the part that a mirror would show, a wide one all of it.
  float narrow = reach * reach / (reach * reach + alpha * alpha);
  vec3 shown = light_representative(light, incoming, s.position, lobes.mirrored);
  float cos_light = mix(horizon_cosine(dot(s.normal, incoming.towards), incoming.sin2),
                        max(dot(s.normal, shown), 0.0),
                        narrow);
  if (cos_light <= 0.0) {
    return vec3(0.0);
  }
  cos_d = dot(s.view, normalize(mix(incoming.towards, shown, narrow) + s.view));
  cos_d = clamp(cos_d, 0.0, 1.0);
  float cos_h = clamp(dot(s.normal, normalize(incoming.towards + s.view)), 0.0, 1.0);
  float lobe = ggx_distribution_over_disk(cos_h, reach, alpha) *
               ggx_visibility(s.cos_view, cos_light, alpha) * cos_light;
  return incoming.irradiance * (light.factors.y * lobe) *
         lobes_reflect(lobes.a, lobes.repeat_a, lobes.b, lobes.repeat_b, cos_d);
}

// What arrives of the light that lobes reflect, by the light samples of a list. The sky's light is hidden
// as it is from a white Lambertian surface that faces the mirrored direction. `lit`: if nothing hid light.
Reflected arriving_glossy(Shading s, int list, Lobes lobes, vec3 of_sky, out vec3 lit)
{
  lit = of_sky;
#ifdef GLASS
  // What glass mirrors of its surroundings is not splatted: the picture's are not those of the search.
  Reflected sum = Reflected(of_sky, of_sky, vec3(0.0));
#else
  Reflected sum = Reflected(of_sky * sky_share(s, list, lobes.mirrored), vec3(0.0), vec3(0.0));
#endif
  for (int i = 0; i < light_count(lights_tx); i++) {
    Light light = light_fetch(lights_tx, i);
    if (light.kind == LIGHT_NONE) {
      continue;
    }
    vec3 reflected = lamp_glossy(s, light, lobes);
    lit += reflected;
    if (reflected != vec3(0.0)) {
      reflected *= lamp_share(s, list, i, light);
      sum.light += reflected;
      sum.unsplit += reflected * light.unsplit;
    }
  }
  return sum;
}

// Light reflected by two lobes of one roughness.
Reflected glossy_light(Shading s, float roughness, Lobe a, Lobe b)
{
  vec3 albedo = ggx_albedo(ggx_tx, s.cos_view, roughness);
  vec3 repeat_a = lobe_repeat(a, albedo);
  vec3 repeat_b = lobe_repeat(b, albedo);
  vec3 mirrored = 2.0 * dot(s.normal, s.view) * s.normal - s.view;
  vec3 reflectance = a.weight * lobe_albedo(a, albedo, s.cos_view) +
                     b.weight * lobe_albedo(b, albedo, s.cos_view);
  vec3 sum = environment_buf.color.rgb * reflectance;
#ifdef REFRACTS
  if (roughness < SPLIT_ROUGHNESS) {
    sum = scene_light(s.position, mirrored, false) * reflectance;
  }
  else
#endif
  if (environment_buf.color.w > 0.5) {
    if (roughness < SPLIT_ROUGHNESS) {
      sum *= environment_radiance(mirrored, roughness);
    }
    else {
      sum = environment_reflection(s, roughness, a, repeat_a, b, repeat_b);
    }
  }
  float alpha = max(roughness * roughness, MIN_ALPHA);
  Lobes lobes = Lobes(alpha, mirrored, a, repeat_a, b, repeat_b);
  vec3 lit;
  Reflected own = arriving_glossy(s, OWN, lobes, sum, lit);
  if (light_is_steady(max(own.light, lit))) {
    Reflected steady = arriving_glossy(s, STEADY, lobes, sum, lit);
    steady.shift = own.light - steady.light;
    return steady;
  }
  return own;
}

#include "passes/surface/surface_closures.glsl"

#else

// Only what passes.
Closure closure_lit(Bsdf bsdf)
{
  vec3 normal = (dot(bsdf.normal, bsdf.normal) > 0.0) ? normalize(bsdf.normal) : point_normal();
  float cos_view = clamp(dot(point_view(), normal), 1e-4, 1.0);
  Closure closure = closure_none();
  if (bsdf.kind == BSDF_FOG) {
    closure.transmittance = fog_transmittance(bsdf);
  }
#ifdef STRAIGHT
  else if (bsdf.kind == BSDF_GLASS) {
    closure.transmittance = glass_transmittance(bsdf, cos_view);
  }
  else if (bsdf.kind == BSDF_PRINCIPLED) {
    float share = clamp(number_or_zero(bsdf.transmission), 0.0, 1.0) *
                  (1.0 - clamp(number_or_zero(bsdf.metallic), 0.0, 1.0));
    bsdf.color = sqrt(max(number_or_zero(bsdf.color), vec3(0.0)));
    closure.transmittance = share * glass_transmittance(bsdf, cos_view);
  }
#endif
  return closure;
}

#endif
