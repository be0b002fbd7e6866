// A square for each highlight, as large as its disc in the picture.
// Inputs: pos (corner, 0 or 1); sources_a_tx, sources_b_tx (see highlights_comp); tiles_tx (what hides
// them, see visibility_lib); view_buf (of the frame), splat_buf.
// Outputs: place on the opening in units of its radius before the anamorphic ratio (v_place), energy
// density (v_density), blur of the disc in the same units (v_blur); see bokeh_look_lib for the rest; tile, number and region of the source.
// Source: methods 1, 13.
#include "lib/lens_lib.glsl"
#include "lib/visibility_lib.glsl"
#include "lib/opening_lib.glsl"
#include "lib/bokeh_look_lib.glsl"

// Signed radius of the circle of confusion at the wavelength that is drawn.
float wavelength_coc(float depth)
{
  float focus = splat_buf.wavelength.w;
  return view_buf.lens.z * ((view_buf.lens.y > 0.5) ? depth * focus - 1.0 : focus - 1.0 / depth);
}

void main()
{
  ivec2 texel = ivec2(gl_InstanceID % SOURCE_COLUMNS, gl_InstanceID / SOURCE_COLUMNS);
  vec4 a = texelFetch(sources_a_tx, texel, 0);
  vec4 b = texelFetch(sources_b_tx, texel, 0);
  v_tile = texelFetch(tiles_tx, texel, 0);
  v_source = gl_InstanceID;
  v_region = b.w;
  float coc = wavelength_coc(a.z);
  vec4 clip = view_buf.projection * vec4(a.xy * splat_buf.lateral.x, -a.z, 1.0);
  vec2 center = (clip.xy / clip.w * 0.5 + 0.5) * view_buf.film.xy;
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
  v_tile_at = vec2(clamp(length(v_chief) * splat_buf.field.x, 0.0, 1.0) * float(TILE_FIELDS - 1),
                   v_row * float(TILE_DEPTHS - 1));
  vec3 pattern = tile_place(places_tx, v_tile_at) * (radius + splat_buf.rows.z);
  pattern = mix(vec3(0.0, radius, radius), pattern, splat_buf.rows.w);
  v_blur = blur * inversesqrt(pattern.y * pattern.z);
  v_upright = (coc < 0.0) ? -1.0 : 1.0;
  v_density = b.rgb * splat_buf.wavelength.rgb * (ratio / (pattern.y * pattern.z));
  if (splat_buf.field.w > 0.5) {
    float layer = opening_layers(float(textureSize(opening_tx, 0).z), v_blur).x;
    v_left_lower = tile_left(left_tx, layer, v_chief, v_tile_at);
    v_left_upper = tile_left(left_tx, layer + 1.0, v_chief, v_tile_at);
  }
  // The widest blur of the tiles, or the pattern with its own.
  vec2 reach = 1.0 + vec2(min(2.0 * v_blur + 0.07, 0.5)) + 0.5 / pattern.yz;
  v_place = (pos * 2.0 - 1.0) * reach;
  vec2 away = azimuth_of(v_chief);
  vec2 local = v_place * pattern.yz + vec2(0.0, pattern.x);
  vec2 offset = (local.x * vec2(away.y, -away.x) + local.y * away) / vec2(ratio, 1.0);
#else
  v_blur = blur / radius;
  // The disc, the wider layer of its blur, and half a pixel.
  vec2 reach = radius * vec2(splat_buf.opening.z / ratio, splat_buf.opening.z) + 1.42 * blur + 0.5;
  vec2 offset = (pos * 2.0 - 1.0) * reach;
  v_place = offset / ((coc < 0.0) ? -radius : radius) * vec2(ratio, 1.0);
  v_density = b.rgb * splat_buf.wavelength.rgb * (ratio / (radius * radius));
#endif
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
  if (v_tile.w == SOURCE_DROP) {
    // No area.
    offset = vec2(0.0);
  }
  gl_Position = vec4((center + offset) / view_buf.film.xy * 2.0 - 1.0, 0.0, 1.0);
}
