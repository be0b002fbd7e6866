// Where the disc of a highlight lies in the picture, and how it is blurred; for the pass that splats it
// and for the one before, which finds its light.
// Reads sources_a_tx, sources_b_tx and what splat_vert names; sets the varyings that disc_lib reads.
// Source: methods 1, 8, 13.
#ifndef SPLAT_DISC_LIB_GLSL
#define SPLAT_DISC_LIB_GLSL
#include "lib/lens_lib.glsl"
#include "lib/bokeh/visibility_lib.glsl"
#include "lib/bokeh/disc_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif
#ifdef REAL_LENS
#include "lib/real_lens_lib.glsl"
#endif

struct SplatDisc {
  bool drawn;     // the light of the source has a disc in this band
  vec2 center;    // px
  float share;    // of the opening's unit square that a pixel covers
  float widest;   // radius with its blur, px
  vec2 reach;     // half the square that holds it: TILES: on the opening, else px
  vec4 pattern;   // TILES: middle and half width of the lens' pattern, px
  vec2 origin;    // place on the opening of the centre,
  mat2 axes;      // and how it changes by px
  float farthest; // light from the centre, px
  bool is_dot;    // about a pixel wide: no layer of the opening has such a blur
  vec2 tent;      // half width of a dot, px
};

#ifdef CHROMATIC

// Whether the colours of a highlight spread as far as the band's level is made for (see BandLevel).
bool is_of_level(vec2 place)
{
  vec2 strengths = abs(field_strengths(field_tx, place, chromatic_buf) - vec2(1.0, 0.0));
  float spread = dot(strengths * vec2(1.0, length(place)), splat_buf.spread.zw);
  return spread >= splat_buf.spread.x && spread < splat_buf.spread.y;
}

// Step of finite differences, as a share of the field's width.
#define FIELD_STEP (1.0 / 256.0)

// 1 / focus distance (1/m) and lateral scale of the band's mean wavelength at a place of the field.
vec2 band_at(vec2 place)
{
  vec2 strengths = field_strengths(field_tx, place, chromatic_buf);
  return vec2(chromatic_focus(splat_buf.dispersion.x, strengths.x, chromatic_buf),
              lateral_scale(splat_buf.dispersion.y, strengths.y, chromatic_buf));
}

// Magnification of a lamp's area at a place of the field, seen from the lens' centre (x), and its
// change for other places on the lens (yz, times the place in units of half the opening).
// With focus f and scale m, the place p appears at m p + v (f - 1 / depth) from v, so that areas
// grow by det(m + p grad(m) + v grad(f)), which is linear in v.
vec3 appearing_area(vec2 place, vec2 band, float depth)
{
  float step_aside = FIELD_STEP / chromatic_buf.field.x;
  vec2 right = band_at(place + vec2(step_aside, 0.0)) - band_at(place - vec2(step_aside, 0.0));
  vec2 above = band_at(place + vec2(0.0, step_aside)) - band_at(place - vec2(0.0, step_aside));
  vec2 focus = vec2(right.x, above.x) / (2.0 * step_aside);
  vec2 scale = vec2(right.y, above.y) / (2.0 * step_aside);
  float cross_product = scale.x * focus.y - scale.y * focus.x;
  vec2 slope = band.y * focus + cross_product * vec2(-place.y, place.x);
  float aperture = view_buf.lens.z / (0.5 * view_buf.film.y * view_buf.projection[1][1]);
  slope *= aperture * ((view_buf.lens.y > 0.5) ? depth : 1.0);
  return vec3(band.y * (band.y + dot(place, scale)), slope / vec2(splat_buf.opening.x, 1.0));
}

// How far the rims of the band's wavelengths lie apart, px.
float band_width(vec2 xy, float depth, vec2 place)
{
  vec2 strengths = field_strengths(field_tx, place, chromatic_buf);
  vec4 band = splat_buf.dispersion;
  float lower = chromatic_focus(band.x - 0.5 * band.z, strengths.x, chromatic_buf);
  float upper = chromatic_focus(band.x + 0.5 * band.z, strengths.x, chromatic_buf);
  float axial = coc_radius_at(depth, upper, view_buf.lens) - coc_radius_at(depth, lower, view_buf.lens);
  // Lateral shift is radial; averaged around the rim, half of its square is across the rim.
  vec2 lateral = xy * (band.w * strengths.y) * 0.5 * view_buf.film.xy *
                 vec2(view_buf.projection[0][0], view_buf.projection[1][1]);
  lateral /= (view_buf.lens.y > 0.5) ? 1.0 : depth;
  return sqrt(axial * axial + 0.5 * dot(lateral, lateral));
}
#endif

// Radius of the disc that has the variance of one with this radius and blur, where a disc can have a
// blur of `most` times its radius at most: along an axis the variance of a disc is radius^2 / 4, that
// of a box of side `blur` blur^2 / 12.
float widened(float radius, float blur, float most)
{
  if (blur <= most * radius) {
    return radius;
  }
  return sqrt((3.0 * radius * radius + blur * blur) / (3.0 + most * most));
}

// The disc of a source: `a` and `b` as in the list of highlights.
SplatDisc splat_disc(vec4 a, vec4 b)
{
  SplatDisc disc;
  disc.drawn = v_tile.w != SOURCE_DROP;
  v_region = b.w;
  // Where the lens' middle sees the highlight beside a pinhole, m.
  vec2 aside = vec2(0.0);
#ifdef REAL_LENS
  aside = real_lens_shift(moves_tx, vec3(a.xy, -a.z), lens_slot, real_lens_buf);
#endif
#ifdef CHROMATIC
  vec2 place = field_place(vec3(a.xy, -a.z), chromatic_buf);
  disc.drawn = disc.drawn && is_of_level(place);
  vec2 band = band_at(place);
  v_area = appearing_area(place, band, a.z);
  float coc = coc_radius_at(a.z, band.x, view_buf.lens);
  vec4 clip = view_buf.projection * vec4(a.xy * band.y + aside, -a.z, 1.0);
  a.w = length(vec2(a.w, band_width(a.xy, a.z, place)));
#else
  float coc = coc_radius_at(a.z, splat_buf.wavelength.w, view_buf.lens);
  vec4 clip = view_buf.projection * vec4(a.xy + aside, -a.z, 1.0);
#endif
  disc.center = (clip.xy / clip.w * 0.5 + 0.5) * view_buf.film.xy;
  float blur = sqrt(a.w * a.w + splat_buf.opening.y * splat_buf.opening.y);
  float ratio = splat_buf.opening.x;
  float radius = max(abs(coc), 1e-6);
  v_chief = (view_buf.lens.y > 0.5) ? vec2(0.0) : a.xy / a.z;
#ifdef PROFILE
  v_row = look_row(coc, splat_buf.rows);
  float extent = profile_texel(profile_tx, 0.5, v_row, 0.0).a;
  radius = mix(radius, extent * (radius + splat_buf.rows.z), splat_buf.rows.w);
#endif
#ifdef TILES
  v_row = look_row(coc, splat_buf.rows);
#ifdef CYLINDERS
  vec2 node = clamp(abs(v_chief) * splat_buf.field.xy, 0.0, 1.0) * float(TILE_ACROSS - 1);
  v_tile_up = node.y;
  v_tile_at = vec2(node.x, v_row * float(TILE_DEPTHS - 1));
  // The middle of the pattern, and half its width.
  vec4 pattern = tile_place_of(places_tx, v_tile_at, v_tile_up);
#else
  v_tile_at = vec2(clamp(length(v_chief) * splat_buf.field.x, 0.0, 1.0) * float(TILE_FIELDS - 1),
                   v_row * float(TILE_DEPTHS - 1));
  vec4 pattern = vec4(0.0, tile_place(places_tx, v_tile_at));
#endif
  pattern *= radius + splat_buf.rows.z;
  pattern = mix(vec4(0.0, 0.0, radius, radius), pattern, splat_buf.rows.w);
  radius = sqrt(pattern.z * pattern.w);
  float wide = widened(radius, blur, TILE_BLUR_SOFT.w);
  pattern.zw *= wide / radius;
  v_blur = min(blur / wide, TILE_BLUR_SOFT.w);
  v_upright = (coc < 0.0) ? -1.0 : 1.0;
  disc.share = ratio / (pattern.z * pattern.w);
#ifdef OPENED
#ifdef CYLINDERS
  // What an opening leaves of even light.
  v_left_lower = v_left_upper = vec3(1.0 / 3.14159265);
#else
  vec2 layers = opening_layers(float(textureSize(opening_tx, 0).z), v_blur);
  // Three tables a layer of the opening: for the blur of the previous layer, its own and the next.
  float table = 3.0 * layers.x + 1.0;
  v_left_lower = mix(tile_left(left_tx, table, v_chief, v_tile_at),
                     tile_left(left_tx, table + 1.0, v_chief, v_tile_at),
                     layers.y);
  v_left_upper = mix(tile_left(left_tx, table + 2.0, v_chief, v_tile_at),
                     tile_left(left_tx, table + 3.0, v_chief, v_tile_at),
                     layers.y);
#endif
#endif
  // Reach of the tiles at their widest blur, or of the pattern with its own.
  disc.reach = 1.0 + vec2(min(2.0 * v_blur + 0.07, 0.5)) + 0.5 / pattern.zw;
  disc.pattern = pattern;
  disc.origin = -pattern.xy / pattern.zw;
  mat2 frame = tile_axes(v_chief);
  // The frame turns or mirrors: its inverse is its transpose.
  disc.axes = mat2(vec2(frame[0].x, frame[1].x) * ratio / pattern.zw,
                   vec2(frame[0].y, frame[1].y) / pattern.zw);
  disc.farthest = length(pattern.xy) +
                  max(pattern.z, pattern.w) * max(disc.reach.x, disc.reach.y);
#else
  float most = OPENING_LEAST_BLUR * exp2(float(textureSize(opening_tx, 0).z) - 1.0);
  float wide = widened(radius, blur, most);
  v_blur = min(blur / wide, most);
  // Reach: the disc, the wider layer of its blur, and half a pixel.
  disc.reach = wide * vec2(splat_buf.opening.z / ratio, splat_buf.opening.z) + 1.42 * blur + 0.5;
  disc.pattern = vec4(0.0);
  disc.origin = vec2(0.0);
  disc.axes = mat2(ratio, 0.0, 0.0, 1.0) / ((coc < 0.0) ? -wide : wide);
  disc.share = ratio / (wide * wide);
  disc.farthest = max(disc.reach.x, disc.reach.y);
#endif
  disc.widest = wide;
#ifdef RIMS
  float layers = float(textureSize(opening_tx, 0).z);
  float lower = opening_layers(layers, v_blur).x;
  float field = length(v_chief) * splat_buf.field.x;
#ifndef PROFILE
  float row = 0.0;
#else
  float row = v_row;
#endif
  v_left_lower = rims_left(left_tx, lower, splat_buf.field.z, row, field, v_chief);
  v_left_upper = rims_left(
      left_tx, min(lower + 1.0, layers - 1.0), splat_buf.field.z, row, field, v_chief);
#endif
  disc.is_dot = false;
  disc.tent = vec2(0.0);
#ifdef CHROMATIC
  disc.is_dot = radius < blur;
  v_dot = disc.is_dot ? 1.0 : 0.0;
  // The layers have no blur wider than the disc: a tent with the variance of both instead.
  vec2 radii = vec2(radius / ratio, radius);
  disc.tent = sqrt(0.5 * blur * blur + 1.5 * radii * radii);
#endif
  return disc;
}

#endif
