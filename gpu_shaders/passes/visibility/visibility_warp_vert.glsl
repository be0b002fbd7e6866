// A square of the atlas for each source that has a mask.
// Inputs: pos (corner, 0 or 1); masked_tx (source by rank), tiles_tx; layout_buf.
// Outputs: v_lens (place on the lens in units of half the opening), v_source (its number).
// Source: methods 11 (J20 section 4.4).
#include "lib/bokeh/source_lib.glsl"

void main()
{
  int source = int(texelFetch(masked_tx, list_texel(gl_InstanceID), 0).x);
  vec4 tile = texelFetch(tiles_tx, list_texel(source), 0);
  v_source = source;
  v_lens = pos * 2.0 - 1.0;
  gl_Position = vec4((tile.xy + pos * tile.z) / layout_buf.atlas.xy * 2.0 - 1.0, 0.0, 1.0);
}
