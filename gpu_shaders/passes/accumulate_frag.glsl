// Copies one lens sample; the blend state adds it to the sum.
// Inputs: sample_tx (same size as the target). Outputs: the sample. Source: methods 1 (HA90).
void main()
{
  out_color = texelFetch(sample_tx, ivec2(gl_FragCoord.xy), 0);
}
