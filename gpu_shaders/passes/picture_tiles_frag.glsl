// The mean of the windows of each tile.
// Inputs: windows_tx (a texel every STRIDE px); count (texels that are windows of the picture).
// Outputs: as windows_tx, a texel a tile of TILE px.

void main()
{
  ivec2 first = ivec2(gl_FragCoord.xy) * (TILE / STRIDE);
  ivec2 end = min(first + TILE / STRIDE, count);
  vec4 total = vec4(0.0);
  for (int y = first.y; y < end.y; y++) {
    for (int x = first.x; x < end.x; x++) {
      total += texelFetch(windows_tx, ivec2(x, y), 0);
    }
  }
  out_color = total / float((end.x - first.x) * (end.y - first.y));
}
