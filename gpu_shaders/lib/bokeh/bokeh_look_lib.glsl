// Shape of a highlight's disc: profile of the lens, rims that cut it, tiles of a real lens' pupil
// (addon/lens_bokeh/look/splat_profile.py, splat_rims.py, splat_pupil.py). Places on the opening are in units of
// its radius.
#ifndef BOKEH_LOOK_LIB_GLSL
#define BOKEH_LOOK_LIB_GLSL
#include "lib/bokeh/opening_lib.glsl"

// Blur of the tiles in units of half their width, and how they are counted: splat_pupil.py.
#define TILE_BLUR_SHARP (1.0 / 48.0)
#define TILE_BLUR_SOFT vec4(1.0 / 20.0, 1.0 / 9.0, 1.0 / 4.0, 1.0 / 2.0)
#ifdef CYLINDERS
// Fields along x and y: cylinder_beams.py.
#define TILE_ACROSS 5
#define TILE_FIELDS 25
#define TILE_DEPTHS 9
#else
#define TILE_FIELDS 9
#define TILE_DEPTHS 25
#endif
#define STOP_OFFSET 1.5
#define STOP_SCALE 3.0

// Where a signed circle of confusion stands among the rows of a profile, 0 to 1; `rows` as in
// SplatParams.
float look_row(float coc, vec4 rows)
{
  float scale = max(abs(coc) + rows.z, 1e-12);
  return clamp((coc / scale - rows.x) * rows.y, 0.0, 1.0);
}

// Texel of a layer of the profile at a radius from 0 to 1 of the layer's reach.
vec4 profile_texel(sampler2DArray tx, float radius, float row, float layer)
{
  float count = float(textureSize(tx, 0).y);
  return texture(tx, vec3(radius, (row * (count - 1.0) + 0.5) / count, layer));
}

// Transmittance of a row of rims (optical vignetting) in a layer of the opening; splat_rims.py.
float rim_share(vec4 rim, vec2 place, vec2 chief, float layer)
{
  float width = max(OPENING_LEAST_BLUR * exp2(layer), opening_extent(layer) / 96.0);
  float members = max(rim.z, 1.0);
  float apart = (members > 1.5) ? length(chief) * abs(rim.y) / members : 0.0;
  float edge = max(width, apart);
  float cleared = 0.0;
  for (float member = 1.0; member <= members; member += 1.0) {
    float inside = rim.x - length(place - chief * (rim.y * member / members));
    cleared += clamp(0.5 + inside / edge, 0.0, 1.0);
  }
  return cleared / members;
}

// Share of a layer's light that passes the rims, by table look-up; `rows` of the table a layer, `row`
// and `field` from 0 to 1.
vec3 rims_left(sampler2DArray tx, float layer, float rows, float row, float field, vec2 chief)
{
  vec2 size = vec2(textureSize(tx, 0).xy);
  float turn = (dot(chief, chief) > 0.0) ? atan(chief.y, chief.x) / 6.28318531 : 0.0;
  float azimuth = turn - floor(turn);
  // The first azimuth of the table is 0, its last one turn.
  vec2 uv = (vec2(clamp(field, 0.0, 1.0), azimuth) * (size - 1.0) + 0.5) / size;
  float place = row * (rows - 1.0);
  float low = min(floor(place), max(rows - 2.0, 0.0));
  vec3 lower = texture(tx, vec3(uv, layer * rows + low)).rgb;
  vec3 upper = texture(tx, vec3(uv, layer * rows + min(low + 1.0, rows - 1.0))).rgb;
  return mix(lower, upper, place - low);
}

// Direction in the picture from the axis to a point; upwards on the axis.
vec2 azimuth_of(vec2 chief)
{
  float size = length(chief);
  return (size > 1e-9) ? chief / size : vec2(0.0, 1.0);
}

// Axes of the tiles in the picture, for their x and y: away from the axis is y. A lens with cylinders has
// no such frame: it is its own mirror image on both sides of both axes.
mat2 tile_axes(vec2 chief)
{
#ifdef CYLINDERS
  return mat2((chief.x < 0.0) ? -1.0 : 1.0, 0.0, 0.0, (chief.y < 0.0) ? -1.0 : 1.0);
#else
  vec2 away = azimuth_of(chief);
  return mat2(vec2(away.y, -away.x), away);
#endif
}

// Outward shift of the middle of a bokeh pattern, and half its width across and along the azimuth,
// all divided by |c| + c0. `at`: field and depth, counted in tiles.
vec3 tile_place(sampler2D tx, vec2 at)
{
  return texture(tx, (at.yx + 0.5) / vec2(TILE_DEPTHS, TILE_FIELDS)).xyz;
}

#ifdef CYLINDERS
// Shift of the middle of a pattern, and half its width, each along x and y, all divided by |c| + c0.
// `at`: field along x, and depth; `up`: field along y.
vec4 tile_place_of(sampler2D tx, vec2 at, float up)
{
  vec2 size = vec2(TILE_DEPTHS, TILE_FIELDS);
  vec2 low = clamp(floor(vec2(at.x, up)), vec2(0.0), vec2(TILE_ACROSS - 2));
  vec2 part = vec2(at.x, up) - low;
  float row = low.y * float(TILE_ACROSS) + low.x;
  vec4 places[4];
  for (int i = 0; i < 4; i++) {
    float field = row + float(i % 2) + float(i / 2) * float(TILE_ACROSS);
    places[i] = texture(tx, vec2(at.y + 0.5, field + 0.5) / size);
  }
  return mix(mix(places[0], places[1], part.x), mix(places[2], places[3], part.x), part.y);
}
#endif

vec3 tile_corner(sampler2DArray tx, vec2 uv, float first, ivec2 at)
{
  return texture(tx, vec3(uv, first + float(at.x * TILE_DEPTHS + at.y))).rgb;
}

// Tiles blurred to one degree: light, and light times the place in the stop.
vec3 tile_layer(sampler2DArray tx, vec2 place, float blur, float first, vec2 at)
{
  vec2 uv = place / (1.0 + blur) * 0.5 + 0.5;
  if (any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) {
    return vec3(0.0);
  }
#ifdef CYLINDERS
  ivec2 low = ivec2(clamp(floor(at), vec2(0.0), vec2(TILE_ACROSS - 2, TILE_DEPTHS - 2)));
  vec2 part = at - vec2(low);
  int above = int(clamp(floor(v_tile_up), 0.0, float(TILE_ACROSS - 2)));
  vec3 rows[2];
  for (int i = 0; i < 2; i++) {
    ivec2 first_of = ivec2((above + i) * TILE_ACROSS, 0) + low;
    vec3 left = mix(tile_corner(tx, uv, first, first_of),
                    tile_corner(tx, uv, first, first_of + ivec2(0, 1)),
                    part.y);
    vec3 right = mix(tile_corner(tx, uv, first, first_of + ivec2(1, 0)),
                     tile_corner(tx, uv, first, first_of + ivec2(1, 1)),
                     part.y);
    rows[i] = mix(left, right, part.x);
  }
  return mix(rows[0], rows[1], v_tile_up - float(above));
#else
  ivec2 low = ivec2(clamp(floor(at), vec2(0.0), vec2(TILE_FIELDS - 2, TILE_DEPTHS - 2)));
  vec2 part = at - vec2(low);
  vec3 near = mix(tile_corner(tx, uv, first, low),
                  tile_corner(tx, uv, first, low + ivec2(0, 1)),
                  part.y);
  vec3 far = mix(tile_corner(tx, uv, first, low + ivec2(1, 0)),
                 tile_corner(tx, uv, first, low + ivec2(1, 1)),
                 part.y);
  return mix(near, far, part.x);
#endif
}

// Light and place in the stop at a place of a tile, in the meridional frame.
vec3 tile_light(sampler2DArray sharp_tx, sampler2DArray soft_tx, vec2 place, float blur, vec2 at)
{
  float count = float(TILE_FIELDS * TILE_DEPTHS);
  float wide = clamp(blur, TILE_BLUR_SHARP, TILE_BLUR_SOFT.w);
  int layer = (wide < TILE_BLUR_SOFT.x) ? 0 :
              (wide < TILE_BLUR_SOFT.y) ? 1 :
              (wide < TILE_BLUR_SOFT.z) ? 2 :
                                          3;
  float low = (layer == 0) ? TILE_BLUR_SHARP : TILE_BLUR_SOFT[layer - 1];
  float high = TILE_BLUR_SOFT[layer];
  // Variances add up: the mixture of two layers has the variance of the blur.
  float share = (wide * wide - low * low) / (high * high - low * low);
  vec3 softer = tile_layer(soft_tx, place, high, float(layer) * count, at);
  vec3 sharper = (layer == 0) ? tile_layer(sharp_tx, place, low, 0.0, at) :
                                tile_layer(soft_tx, place, low, float(layer - 1) * count, at);
  vec3 light = mix(sharper, softer, share);
  vec2 stop = light.yz / max(light.x, 1e-12) * STOP_SCALE - STOP_OFFSET;
  return vec3(light.x, stop);
}

// Share of the tiles' light that passes the opening; array over tables and fields, azimuth by depth.
vec3 tile_left(sampler2DArray tx, float table, vec2 chief, vec2 at)
{
  float turn = (dot(chief, chief) > 0.0) ? atan(chief.y, chief.x) / 6.28318531 : 0.25;
  vec2 size = vec2(textureSize(tx, 0).xy);
  vec2 uv = (vec2(at.y, (turn - floor(turn)) * (size.y - 1.0)) + 0.5) / size;
  float low = clamp(floor(at.x), 0.0, float(TILE_FIELDS - 2));
  float first = table * float(TILE_FIELDS) + low;
  return mix(texture(tx, vec3(uv, first)).rgb, texture(tx, vec3(uv, first + 1.0)).rgb, at.x - low);
}

#endif
