// Shadows of lit surfaces: of each light, what arrives from its light samples. Of lamps it is a ratio of what
// those give that nothing hides to what all of them give: where nothing hides a light there is no noise,
// and what is hidden gives nothing, never less.
// Included by surface_lighting. Light that may be splatted as a highlight is shadowed by the steady light
// samples, the same in every drawing, so that what is splatted and what lens samples keep add up; how the
// shadows of this drawing differ from those is `shift`.
// Source: ratio of shadowed to unshadowed light, Heitz et al., I3D 2018.

// Reflected by a white surface of the shape, of one lamp.
vec3 lamp_diffuse(Shading s, Light light, Illumination incoming)
{
  return incoming.irradiance *
         (light.factors.x * diffuse_response(s, incoming.towards, incoming.sin2));
}

// Rows of lit_by_tx: light samples of this drawing, and those that all drawings share.
#define OWN 0
#define STEADY 1

#ifdef SHADOWS

// From this share of the highlight threshold on light may be splatted.
#define STEADY_FROM 0.75
// Most light samples in a list, 32 a word; sampling/lights/light_turns.py.
#define LIST_WORDS 4

// Which light samples of the lists were asked for, and which of those are hidden, a bit each.
uint asked[2 * LIST_WORDS] = uint[](0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
uint hidden[2 * LIST_WORDS] = uint[](0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);

// Light samples of a light in a list: column of the first, their number, and the weight of its light.
struct LightTurn {
  int first;
  int count;
  float weight;
};

// `light`: its number; that of the sky is the number of lights.
LightTurn light_turn(int list, int light)
{
  vec4 texel = texelFetch(lit_by_tx, ivec2(light, list), 0);
  return LightTurn(int(texel.x + 0.5), int(texel.y + 0.5), texel.z);
}

// Row in the light table of the light sample in a column of a list.
int light_sample_row(int list, int column)
{
  return int(texelFetch(lights_tx, ivec2(0, 0), 0).y + 0.5) +
         int(texelFetch(lit_by_tx, ivec2(column, list), 0).x + 0.5);
}

// Whether the light sample in a column of a list reaches the surface.
bool light_sample_arrives(Shading s, int list, int column, int row)
{
  int number = column - light_count(lights_tx) - 1;
  int word = list * LIST_WORDS + (number >> 5);
  uint bit = 1u << uint(number & 31);
  if ((asked[word] & bit) == 0u) {
    asked[word] |= bit;
    float away = slack;
    if (away > 0.0) {
      mat4 world = instance_world(instances_tx, instance_row);
      away *= max(length(world[0].xyz), max(length(world[1].xyz), length(world[2].xyz)));
    }
    if (light_map_hides(lights_tx, light_maps_tx, row, s.position, s.geometric, away)) {
      hidden[word] |= bit;
    }
  }
  return (hidden[word] & bit) == 0u;
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

// How much a place on a lamp gives a surface, in proportion to the lamp's other places.
float lamp_place_light(Shading s, Light light, vec3 place)
{
  if (light.kind == LIGHT_SUN) {
    return max(dot(s.normal, -place), 0.0);
  }
  vec3 offset = place - s.position;
  float distance2 = max(dot(offset, offset), 1e-12);
  vec3 towards = offset * inversesqrt(distance2);
  float given = max(dot(s.normal, towards), 0.0);
  if (light.kind == LIGHT_AREA) {
    given *= max(dot(light.direction, -towards), 0.0) *
             light_beam(light, -towards, sqrt(distance2)) / distance2;
  }
  return given;
}

// The share of a lamp's light that arrives; `light`: of the number `number`.
float lamp_share(Shading s, int list, int number, Light light)
{
  LightTurn turn = light_turn(list, number);
  if (turn.count == 0 || turn.weight <= 0.0) {
    return turn.weight;
  }
  float whole = 0.0, arriving = 0.0, seen = 0.0;
  for (int i = 0; i < turn.count; i++) {
    int row = light_sample_row(list, turn.first + i);
    float given = lamp_place_light(s, light, texelFetch(lights_tx, ivec2(1, row), 0).xyz);
    if (light_sample_arrives(s, list, turn.first + i, row)) {
      arriving += given;
      seen += 1.0;
    }
    whole += given;
  }
  // A part of the lamp may be above the horizon of a surface, but none of these places.
  float share = (whole > 0.0) ? arriving / whole : seen / float(turn.count);
  return turn.weight * share;
}

// The share of the sky's light on a white Lambertian surface of a normal that arrives: the part of it that
// the directions say which are not hidden, corrected by how much more or less than their part these give:
// a control variate that is exact where all or none are hidden. If there are two groups of directions, each
// is corrected by what is hidden of the other, of which it is independent: where more light comes from
// is mostly more open, too, so that a group corrected by itself is too dark, by up to 1 part in 30 of what
// gets into a room. Few directions of a weak sky are one group.
vec3 sky_share(Shading s, int list, vec3 normal)
{
  LightTurn turn = light_turn(list, light_count(lights_tx));
  if (turn.count == 0) {
    return vec3(1.0);
  }
  vec3 arriving = vec3(0.0), first = vec3(0.0), second = vec3(0.0);
  vec2 number = vec2(0.0), above = vec2(0.0), open = vec2(0.0);
  for (int i = 0; i < turn.count; i++) {
    int row = light_sample_row(list, turn.first + i);
    vec4 direction = texelFetch(lights_tx, ivec2(1, row), 0);
    vec2 is_of = vec2(1.0 - direction.w, direction.w);
    number += is_of;
    float cosine = dot(normal, direction.xyz);
    if (cosine <= 0.0) {
      continue;
    }
    vec3 given = texelFetch(lights_tx, ivec2(2, row), 0).rgb * (cosine / (PI * float(turn.count)));
    first += given * is_of.x;
    second += given * is_of.y;
    above += is_of * cosine;
    if (light_sample_arrives(s, list, turn.first + i, row)) {
      arriving += given;
      open += is_of * cosine;
    }
  }
  if (open == above) {
    return vec3(1.0);
  }
  if (open == vec2(0.0)) {
    return vec3(0.0);
  }
  // By the cosine: a direction that grazes a surface, where a map says little, says as little here.
  float part = (open.x + open.y) / (above.x + above.y);
  vec2 parts = vec2((above.x > 0.0) ? open.x / above.x : part,
                    (above.y > 0.0) ? open.y / above.y : part);
  vec3 whole = environment_diffuse(normal);
  vec2 shares = number / float(turn.count);
  arriving += parts.y * (shares.x * whole - first) + parts.x * (shares.y * whole - second);
  return max(arriving, vec3(0.0)) / max(whole, vec3(1e-12));
}

#else

// Nothing hides light.
vec3 sky_share(Shading s, int list, vec3 normal)
{
  return vec3(1.0);
}

float lamp_share(Shading s, int list, int number, Light light)
{
  return 1.0;
}

bool light_is_steady(vec3 light)
{
  return false;
}
#endif
