// One lens sample's pixels from its sub-pixels; the blend state adds them to the sum.
// Inputs: sample_tx (SUBPIXELS times as large as the target); columns, rows (weights of sub-pixels).
// CHROMATIC: tint (weights of the channels, that of the sample's wavelength).
// LIGHT: light_tx, light_table, light_sets (what the lens lets through at the places of the picture, see
// light_table_lib), size (of the picture, px).
// Outputs: the weighted sample. Source: methods 1 (HA90).
#include "lib/subpixel_lib.glsl"
#ifdef LIGHT
#include "lib/light_table_lib.glsl"
#endif

void main()
{
  out_color = subpixel_sum(sample_tx, ivec2(gl_FragCoord.xy), columns, rows);
#ifdef CHROMATIC
  out_color *= tint;
#endif
#ifdef LIGHT
  out_color *= light_at_pixel(
      light_tx, gl_FragCoord.xy / size, light_table, light_sets, ivec2(gl_FragCoord.xy)).x;
#endif
}
