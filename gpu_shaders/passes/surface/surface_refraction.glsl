// What glass shows of the scene behind it: light bent where it enters and where it leaves (**ours**). A lens
// sample sees the scene from one point, so that all is sharp in it; as each sees it bent from
// another place, what is behind glass gets its own circle of confusion over the samples, not the glass'.
// Included by surface_lighting where surfaces refract; libraries stand before it.
// Inputs: behind_tx, behind_depth_tx (the sample's picture and window depth without this glass), exits_tx
// (backs of the glass: normal, window depth; 0 where there is none), probe_tx, probe_depth_tx and
// glass_buf (see probe_lib); what places a point in the sample's raster.
// Source: exits after Wyman, SIGGRAPH 2005; rays through depth buffers after McGuire and Mara, JCGT 3(4), 2014.

#define EXIT_STEPS 12
#define EXIT_HALVINGS 8
#define SCREEN_STEPS 32
#define SCREEN_HALVINGS 8
// Where a ray meets a surface that goes on, depths on both sides of the crossing differ by less than this
// share of the depth.
#define SAME_SURFACE 0.03
// Roughness of what is as clear as a mirror.
#define CLEAR 0.01

// Clip coordinates of a place as the lens sample sees it, as surface_vert has them.
vec4 seen_clip(vec3 place)
{
  vec3 point = (view_buf.view * vec4(place, 1.0)).xyz;
#ifdef CHROMATIC
  vec3 seen = chromatic_displace(field_tx, point, lens_sample.xy, dispersion, chromatic_buf);
#else
  vec3 seen = lens_displace(point, lens_sample.xy, view_buf.lens.x);
#endif
#ifdef REAL_LENS
  seen.xy += real_lens_shift(moves_tx, point, lens_slot, real_lens_buf);
#endif
  vec4 clip = view_buf.projection * vec4(seen, 1.0);
  clip.xy += lens_sample.zw * clip.w;
  return clip;
}

// Place in the raster, texels, and window depth.
vec3 on_raster(vec3 normalized)
{
  return (normalized * 0.5 + 0.5) * vec3(view_buf.film.xy, 1.0);
}

bool is_drawn(vec2 place)
{
  return all(greaterThanEqual(place, glass_buf.part.xy)) && all(lessThan(place, glass_buf.part.zw));
}

vec3 world_light(vec3 direction, float roughness)
{
  vec3 color = environment_buf.color.rgb;
  return (environment_buf.color.w > 0.5) ? color * environment_radiance(direction, roughness) : color;
}

// Where nothing is, farther than any ray.
float window_depth_at(vec2 place)
{
  float depth = texelFetch(behind_depth_tx, ivec2(place), 0).x;
  return (depth < 1.0) ? depth : 1e9;
}

float linear_depth(float window_depth)
{
  return depth_from_window(window_depth, view_buf.projection, view_buf.lens);
}

// The light that comes along a ray, where the lens sample's own picture has it. `a` is 0 where it
// has not.
vec4 screen_light(vec3 start, vec3 direction)
{
  vec4 from = seen_clip(start);
  // So far along that the ray's end is its vanishing point.
  float reach = 1e3 * max(from.w, glass_buf.probe.w);
  vec4 to = seen_clip(start + reach * direction);
  if (from.w <= 0.0 || to.w <= from.w * 1e-3) {
    return vec4(0.0);
  }
  vec3 a = on_raster(from.xyz / from.w), b = on_raster(to.xyz / to.w);
  // Up to the raster's border.
  vec2 way = b.xy - a.xy;
  vec2 border = mix(glass_buf.part.xy, glass_buf.part.zw, greaterThan(way, vec2(0.0)));
  vec2 limit = mix((border - a.xy) / way, vec2(1e30), lessThan(abs(way), vec2(1e-4)));
  float end = min(min(limit.x, limit.y), 1.0);
  if (end <= 0.0 || !is_drawn(a.xy)) {
    return vec4(0.0);
  }
  // Another place of the steps in each lens sample.
  float shift = hash_unit(hash_combine(floatBitsToUint(lens_sample.z), uint(sample_index) + 7u));
  float before = 0.0;
  bool was_front = true;
  for (int i = 0; i < SCREEN_STEPS; i++) {
    float here = (i + 1 < SCREEN_STEPS) ? end * (float(i) + shift) / float(SCREEN_STEPS) :
                                          end * 0.99999;
    vec3 place = mix(a, b, here);
    bool front = place.z <= window_depth_at(place.xy);
    if (was_front && !front) {
      float low = before, high = here;
      for (int k = 0; k < SCREEN_HALVINGS; k++) {
        float middle = 0.5 * (low + high);
        vec3 tried = mix(a, b, middle);
        if (tried.z > window_depth_at(tried.xy)) {
          high = middle;
        }
        else {
          low = middle;
        }
      }
      vec2 hit = mix(a.xy, b.xy, high);
      float depth = linear_depth(window_depth_at(hit));
      if (abs(linear_depth(window_depth_at(mix(a.xy, b.xy, low))) - depth) <= SAME_SURFACE * depth) {
        return vec4(texelFetch(behind_tx, ivec2(hit), 0).rgb, 1.0);
      }
    }
    was_front = front;
    before = here;
  }
  if (end >= 1.0 && was_front) {
    // The sky at the vanishing point.
    return vec4(world_light(direction, 0.0), 1.0);
  }
  return vec4(0.0);
}

// The light that comes to the probe from a direction.
vec3 probe_light(vec3 direction)
{
  vec2 place = probe_place(direction, glass_buf.clip.z).xy;
  return (textureLod(probe_depth_tx, place, 0.0).x < 1.0) ? textureLod(probe_tx, place, 0.0).rgb :
                                                             world_light(direction, 0.0);
}

// The light that comes along a ray: of the sample's picture, of the probe, of the world.
vec3 scene_light(vec3 start, vec3 direction, bool on_screen)
{
  if (on_screen) {
    vec4 seen = screen_light(start, direction);
    if (seen.a > 0.0) {
      return seen.rgb;
    }
  }
  vec3 relative = start - glass_buf.probe.xyz;
  float along = probe_trace(
      probe_depth_tx, relative, direction, glass_buf.probe.w, glass_buf.clip);
  if (along < 0.0) {
    return world_light(direction, 0.0);
  }
  vec3 place = probe_place(relative + along * direction, glass_buf.clip.z);
  return textureLod(probe_tx, place.xy, 0.0).rgb;
}

// A facet of a rough face, the same in all pixels of a lens sample: no noise between them.
vec3 facet_normal(vec3 normal, vec3 view, float roughness, uint number)
{
  if (roughness < CLEAR) {
    return normal;
  }
  vec3 up = (abs(normal.z) < 0.9) ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
  vec3 tangent = normalize(cross(up, normal)), bitangent = cross(normal, tangent);
  vec3 local = vec3(dot(view, tangent), dot(view, bitangent), max(dot(view, normal), 1e-4));
  vec2 u = vec2(hash_spread(uint(sample_index), 2u * number + 11u),
                hash_spread(uint(sample_index), 2u * number + 12u));
  vec3 h = ggx_visible_normal(normalize(local), roughness * roughness, u);
  return normalize(tangent * h.x + bitangent * h.y + normal * h.z);
}

// Where a ray inside the glass reaches its back: the place, and the back's normal against the ray (0: no
// back was found).
vec3 find_exit(vec3 start, vec3 direction, out vec3 normal)
{
  vec4 a = seen_clip(start), b = seen_clip(start + 2.0 * glass_buf.probe.w * direction);
  float low = 0.0, high = 1.0;
  bool found = false;
  for (int i = 1; i <= EXIT_STEPS && !found; i++) {
    float here = float(i) / float(EXIT_STEPS);
    vec4 clip = mix(a, b, here);
    vec3 place = on_raster(clip.xyz / max(clip.w, 1e-9));
    float back = texelFetch(exits_tx, ivec2(place.xy), 0).w;
    found = !is_drawn(place.xy) || place.z >= back;
    high = here;
    low = found ? low : here;
  }
  for (int k = 0; k < EXIT_HALVINGS; k++) {
    float middle = 0.5 * (low + high);
    vec4 clip = mix(a, b, middle);
    vec3 place = on_raster(clip.xyz / max(clip.w, 1e-9));
    if (!is_drawn(place.xy) || place.z >= texelFetch(exits_tx, ivec2(place.xy), 0).w) {
      high = middle;
    }
    else {
      low = middle;
    }
  }
  vec4 clip = mix(a, b, low);
  vec4 back = texelFetch(exits_tx, ivec2(on_raster(clip.xyz / max(clip.w, 1e-9)).xy), 0);
  normal = (back.w > 0.0) ? back.xyz : vec3(0.0);
  normal = (dot(normal, direction) > 0.0) ? -normal : normal;
  return start + low * 2.0 * glass_buf.probe.w * direction;
}

// The light that comes through a face of glass, and through the glass' back. `tint`: what a face leaves
// of the light; `mirrors`: faces reflect what they do not let through.
vec3 refracted_light(Shading s, float roughness, float eta, vec3 tint, bool mirrors)
{
  bool inside = point_backfacing() > 0.5;
  float index = inside ? 1.0 / eta : eta;
  vec3 facet = facet_normal(s.normal, s.view, roughness, 0u);
  vec3 bent = refract(-s.view, facet, 1.0 / index);
  float passed = mirrors ? 1.0 - fresnel_dielectric(dot(s.view, facet), index) : 1.0;
  if (bent == vec3(0.0) || passed <= 0.0) {
    return vec3(0.0);
  }
  vec3 back;
  vec3 leaves = inside ? s.position : find_exit(s.position, bent, back);
  if (inside || back == vec3(0.0)) {
    return tint * passed * scene_light(s.position, bent, true);
  }
  facet = facet_normal(normalize(back), -bent, roughness, 1u);
  vec3 out_again = refract(bent, facet, eta);
  vec3 kept = reflect(bent, facet);
  float lost = mirrors ? fresnel_dielectric(dot(bent, facet), 1.0 / eta) : 0.0;
  bool leaves_at_once = out_again != vec3(0.0);
  if (!leaves_at_once && !mirrors) {
    return vec3(0.0);
  }
  // What is reflected inside leaves elsewhere, here as it goes.
  vec3 light = scene_light(leaves, leaves_at_once ? out_again : kept, leaves_at_once);
  if (leaves_at_once && lost > 0.0) {
    light = mix(light, probe_light(kept), lost);
  }
  return tint * tint * passed * light;
}
