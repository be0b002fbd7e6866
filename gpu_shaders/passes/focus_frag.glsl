// The focus matte of one lens sample; the blend state adds it to the sum.
// Inputs: mattes_tx (SUBPIXELS times as large as the target); columns, rows (weights of sub-pixels).
// LIGHT: as in accumulate_frag.
// Outputs: the share, 0 to 1 times the weights. Source: methods 1.
#include "lib/subpixel_lib.glsl"
#ifdef LIGHT
#include "lib/light_table_lib.glsl"
#endif

void main()
{
  out_share = subpixel_sum(mattes_tx, ivec2(gl_FragCoord.xy), columns, rows).w;
#ifdef LIGHT
  out_share *= light_at_pixel(
      light_tx, gl_FragCoord.xy / size, light_table, light_sets, ivec2(gl_FragCoord.xy)).x;
#endif
}
