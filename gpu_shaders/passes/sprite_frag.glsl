// Copies a drawing of one object, shifted by whole pixels: into a sprite (STORE), or from a sprite
// into a lens sample, where it takes part in the depth test.
// Inputs: color_tx, depth_tx, with MATTES also mattes_tx; origin (texel of the source below the
// target's texel 0, 0).
// Outputs: colour; with MATTES the mattes; depth, as a colour (STORE) or into the depth buffer.
// Source: methods 4 (JKL13 section 5, algorithm 1).
void main()
{
  ivec2 texel = ivec2(gl_FragCoord.xy) + origin;
  float depth = texelFetch(depth_tx, texel, 0).x;
#ifdef STORE
  out_depth = depth;
#else
  if (depth >= 1.0) {
    discard;
  }
  gl_FragDepth = depth;
#endif
  out_color = texelFetch(color_tx, texel, 0);
#ifdef MATTES
  out_mattes = texelFetch(mattes_tx, texel, 0);
#endif
}
