// Copies one lens sample's share of sharpness; the blend state adds it to the sum.
// Inputs: mattes_tx (same size as the target). Outputs: the share, 0 to 1. Source: methods 1.
void main()
{
  out_share = texelFetch(mattes_tx, ivec2(gl_FragCoord.xy), 0).w;
}
