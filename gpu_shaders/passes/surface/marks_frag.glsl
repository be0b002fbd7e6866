// Marks what is shaded in one go, by its number, as depth.
// Inputs: depth_tx, the depth of surfaces; surface_0_tx (w: number from 1); marks (numbers there may be).
// Outputs: depth: number over marks; 1 where there is nothing.
void main()
{
  ivec2 texel = ivec2(gl_FragCoord.xy);
  bool there = texelFetch(depth_tx, texel, 0).x < 1.0;
  gl_FragDepth = there ? texelFetch(surface_0_tx, texel, 0).w / marks : 1.0;
}
