// One lens sample's pixels from its sub-pixels; the blend state adds them to the sum.
// Inputs: sample_tx (SUBPIXELS times as large as the target); columns, rows (weights of sub-pixels).
// CHROMATIC: tint (weights of the channels, that of the sample's wavelength).
// Outputs: the weighted sample. Source: methods 1 (HA90).
#include "lib/subpixel_lib.glsl"

void main()
{
  out_color = subpixel_sum(sample_tx, ivec2(gl_FragCoord.xy), columns, rows);
#ifdef CHROMATIC
  out_color *= tint;
#endif
}
