// Transmittance of a surface; the blend state multiplies the mask by it.
// Inputs: varyings of visibility_surface_vert; what the generated surface_closure() reads.
// Outputs: share of the light that passes.
// Source: methods 11.

void main()
{
  vec2 place = gl_FragCoord.xy - v_tile.xy;
  if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(v_tile.z)))) {
    discard;
  }
#ifdef TRANSPARENT
  out_mask = vec4(closure_through(surface_closure()));
#else
  out_mask = vec4(0.0);
#endif
}
