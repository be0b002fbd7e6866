// A square for each highlight, as large as its disc in the picture.
// Inputs: pos (corner, 0 or 1); sources_a_tx, sources_b_tx (see highlights_comp); tiles_tx (what hides
// them, see visibility_lib); view_buf (of the frame), splat_buf.
// Outputs: place on the opening in units of its radius before the anamorphic ratio (v_place), energy
// density (v_density), blur of the disc in the same units (v_blur); tile, number and region of the source.
// Source: methods 1, 13.
#include "lib/lens_lib.glsl"
#include "lib/visibility_lib.glsl"

void main()
{
  ivec2 texel = ivec2(gl_InstanceID % SOURCE_COLUMNS, gl_InstanceID / SOURCE_COLUMNS);
  vec4 a = texelFetch(sources_a_tx, texel, 0);
  vec4 b = texelFetch(sources_b_tx, texel, 0);
  v_tile = texelFetch(tiles_tx, texel, 0);
  v_source = gl_InstanceID;
  v_region = b.w;
  float coc = coc_radius_px(a.z, view_buf.lens);
  vec4 clip = view_buf.projection * vec4(a.xy, -a.z, 1.0);
  vec2 center = (clip.xy / clip.w * 0.5 + 0.5) * view_buf.film.xy;
  float blur = sqrt(a.w * a.w + splat_buf.opening.y * splat_buf.opening.y);
  v_blur = blur / abs(coc);
  float ratio = splat_buf.opening.x;
  // The disc, its blur, and half a pixel.
  vec2 reach = abs(coc) * vec2(splat_buf.opening.z / ratio, splat_buf.opening.z) + blur + 0.5;
  vec2 offset = (pos * 2.0 - 1.0) * reach;
  v_place = offset / coc * vec2(ratio, 1.0);
  v_density = b.rgb * (ratio / (coc * coc));
  if (v_tile.w == SOURCE_DROP) {
    // No area.
    offset = vec2(0.0);
  }
  gl_Position = vec4((center + offset) / view_buf.film.xy * 2.0 - 1.0, 0.0, 1.0);
}
