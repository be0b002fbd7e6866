// How much of the world's light passes surfaces that are as good as infinitely far: all of the lens sees
// the world behind them. Blended by multiplication.
// Inputs: varyings of surface_vert; view_buf; nearest (depth along the axis from which on a surface
// covers, m); what the generated surface_closure() reads of a transparent surface.
// Outputs: share that passes (all components).
// Source: methods 9 (J20 section 4.1).

void main()
{
  if (-(view_buf.view * vec4(world_position, 1.0)).z <= nearest) {
    discard;
  }
  float through = 0.0;
#if defined(TRANSPARENT) && !defined(HOLDOUT)
  through = clamp(closure_through(surface_closure()), 0.0, 1.0);
#endif
  out_color = vec4(through);
}
