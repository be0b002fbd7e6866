// Shadows of lit surfaces: of the light of all lamps, what the light samples of a drawing do not reach is
// taken away, in proportion to what each of them stands for.
// Included by surface_lighting. Light that may be splatted as a highlight is shadowed by the steady light
// samples, the same in every drawing, so that what is splatted and what lens samples keep add up; how the
// shadows of this drawing differ from those is `shift`.

// Reflected by a white surface of the shape, of one lamp.
vec3 lamp_diffuse(Shading s, Light light, Illumination incoming)
{
  return incoming.irradiance *
         (light.factors.x * diffuse_response(s, incoming.towards, incoming.sin2));
}

#ifdef SHADOWS

// From this share of the highlight threshold on light may be splatted.
#define STEADY_FROM 0.75
// Most that a place on an area light gives of what its whole does.
#define LARGEST_PART 4.0

// Light samples of a list: their places in the atlas, and which of them do not reach the fragment, a bit
// each.
struct Shadowing {
  ivec4 places;
  ivec4 more_places;
  uint hiding;
  float share;  // of a light sample
};

// Found when they are first asked for.
bool own_known = false, steady_known = false;
Shadowing own_samples, steady_samples;

Shadowing find_shadowing(ivec4 places, ivec4 more_places, Shading s)
{
  float away = slack;
  if (away > 0.0) {
    mat4 world = instance_world(instances_tx, instance_row);
    away *= max(length(world[0].xyz), max(length(world[1].xyz), length(world[2].xyz)));
  }
  Shadowing found;
  found.places = places;
  found.more_places = more_places;
  found.hiding =
      light_maps_hiding(lights_tx, light_maps_tx, places, more_places, s.position, s.geometric, away);
  found.share = 1.0 / float(max(light_maps_count(places, more_places), 1));
  return found;
}

Shadowing own_shadowing(Shading s)
{
  if (!own_known) {
    own_samples = find_shadowing(light_places, more_light_places, s);
    own_known = true;
  }
  return own_samples;
}

Shadowing steady_shadowing(Shading s)
{
  if (!steady_known) {
    steady_samples = find_shadowing(ivec4(steady_places, 0, 0), ivec4(0), s);
    steady_known = true;
  }
  return steady_samples;
}

// Whether light may be splatted, so that all drawings must agree on its shadows.
bool light_is_steady(vec3 light)
{
#ifdef HIGHLIGHTS
#if !defined(CHROMATIC) && !defined(REAL_LENS)
  // What is nearly in focus is not splatted.
  float depth = -(view_buf.view * vec4(world_position, 1.0)).z;
  if (highlight_share(coc_radius_px(depth, view_buf.lens), highlight_buf.split.y) <= 0.0) {
    return false;
  }
#endif
  return max(light.r, max(light.g, light.b)) > STEADY_FROM * highlight_buf.split.x;
#else
  return false;
#endif
}

// Row of a light sample in the light table.
int light_sample_row(Shadowing shadowing, int i)
{
  return int(texelFetch(lights_tx, ivec2(0, 0), 0).y + 0.5) +
         light_map_place(shadowing.places, shadowing.more_places, i) - 1;
}

// What a place on an area light gives of the light of its whole, 1 on the average over places.
float lamp_part(Shading s, Light light, Illumination incoming, vec3 place)
{
  float whole = horizon_cosine(dot(s.normal, incoming.towards), incoming.sin2) *
                dot(incoming.irradiance, vec3(1.0));
  if (light.kind != LIGHT_AREA || whole <= 0.0) {
    return 1.0;
  }
  vec3 offset = place - s.position;
  float distance2 = max(dot(offset, offset), 1e-12);
  vec3 towards = offset * inversesqrt(distance2);
  float area = 4.0 * light.half_size.x * light.half_size.y;
  float part = area * max(dot(light.direction, -towards), 0.0) * max(dot(s.normal, towards), 0.0) *
               light_beam(light, -towards, sqrt(distance2)) * dot(light.radiance, vec3(1.0)) / distance2;
  return clamp(part / whole, 0.0, LARGEST_PART);
}

// Of the sky's light on a white Lambertian surface of a normal, what a light sample of it stands for.
vec3 sky_diffuse(vec3 normal, vec4 head, int row)
{
  vec3 towards = texelFetch(lights_tx, ivec2(1, row), 0).xyz;
  vec3 light = texelFetch(lights_tx, ivec2(2, row), 0).rgb;
  vec2 place = direction_to_octahedron(normal);
  return light * (max(dot(normal, towards), 0.0) / PI *
                  sky_correction(lights_tx, place, int(head.w + 0.5)));
}

// Of `diffuse_light`, what light samples of a list do not reach.
Reflected hidden_diffuse_of(Shading s, Shadowing shadowing)
{
  Reflected hidden = Reflected(vec3(0.0), vec3(0.0), vec3(0.0));
  for (int i = 0; i < LIGHT_MAPS; i++) {
    if ((shadowing.hiding >> uint(i)) == 0u) {
      break;
    }
    if (((shadowing.hiding >> uint(i)) & 1u) == 0u) {
      continue;
    }
    int row = light_sample_row(shadowing, i);
    vec4 head = texelFetch(lights_tx, ivec2(0, row), 0);
    if (head.x < 0.0) {
      hidden.light += diffuse_share(s) * sky_diffuse(diffuse_axis(s), head, row) *
                      (head.y * shadowing.share);
      continue;
    }
    vec3 place = texelFetch(lights_tx, ivec2(1, row), 0).xyz;
    Light light = light_fetch(lights_tx, int(head.x + 0.5));
    Illumination incoming = light_illuminate(light, s.position);
    vec3 reflected = lamp_diffuse(s, light, incoming) * lamp_part(s, light, incoming, place) *
                     (head.y * shadowing.share);
    hidden.light += reflected;
    hidden.unsplit += reflected * light.unsplit;
  }
  return hidden;
}

Reflected hidden_diffuse(Shading s, vec3 lit)
{
  Reflected own = hidden_diffuse_of(s, own_shadowing(s));
  if (!light_is_steady(lit)) {
    return own;
  }
  Reflected steady = hidden_diffuse_of(s, steady_shadowing(s));
  steady.shift = steady.light - own.light;
  return steady;
}
#endif
