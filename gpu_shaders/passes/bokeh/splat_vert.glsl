// A square for each highlight, as large as its disc in the picture.
// Inputs: pos (corner, 0 or 1); sources_a_tx, sources_b_tx (see highlights_comp); tiles_tx (masks of
// the sources, see visibility_lib); density_tx (see splat_density_comp); view_buf (of the frame),
// splat_buf. CHROMATIC: chromatic_buf, field_tx (field table). REAL_LENS: real_lens_buf, moves_tx and
// lens_slot (tables of the lens' middle).
// Outputs: place on the opening in units of its radius before the anamorphic ratio (v_place), energy
// density (v_density), blur of the disc in the same units (v_blur); see bokeh_look_lib for the rest; tile, number and region of the source.
// Source: methods 1, 8, 13.
#include "lib/bokeh/splat_disc_lib.glsl"

void main()
{
  ivec2 texel = ivec2(gl_InstanceID % SOURCE_COLUMNS, gl_InstanceID / SOURCE_COLUMNS);
  vec4 a = texelFetch(sources_a_tx, texel, 0);
  vec4 b = texelFetch(sources_b_tx, texel, 0);
  v_tile = texelFetch(tiles_tx, texel, 0);
  v_source = gl_InstanceID;
  v_density = texelFetch(density_tx, texel, 0).rgb;
  SplatDisc disc = splat_disc(a, b);
  vec2 corner = pos * 2.0 - 1.0;
#ifdef TILES
  v_place = corner * disc.reach;
  vec2 offset = tile_axes(v_chief) * (v_place * disc.pattern.zw + disc.pattern.xy) /
                vec2(splat_buf.opening.x, 1.0);
#else
  vec2 offset = corner * disc.reach;
  v_place = disc.axes * offset;
#endif
  if (disc.is_dot) {
    v_place = corner;
    offset = corner * disc.tent;
  }
  if (!disc.drawn) {
    // No disc: a triangle without area.
    offset = vec2(0.0);
  }
  gl_Position = vec4((disc.center + offset) / view_buf.film.xy * 2.0 - 1.0, 0.0, 1.0);
}
