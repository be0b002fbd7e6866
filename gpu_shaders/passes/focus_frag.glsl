// The focus matte of one lens sample; the blend state adds it to the sum.
// Inputs: mattes_tx (SUBPIXELS times as large as the target); columns, rows (weights of sub-pixels).
// Outputs: the share, 0 to 1 times the weights. Source: methods 1.
#include "lib/subpixel_lib.glsl"

void main()
{
  out_share = subpixel_sum(mattes_tx, ivec2(gl_FragCoord.xy), columns, rows).w;
}
