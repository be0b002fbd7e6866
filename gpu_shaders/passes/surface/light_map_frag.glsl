// What hides light, seen from a light: its depth. Light passes transparent surfaces by chance, so that
// over the light samples what passes is in proportion to their transmittance.
// Inputs: varyings of surface_vert; view_buf of the light; the generated surface_closure() of
// transparent surfaces; sample_index.
// Outputs: depth.
// Source: stochastic transparency and shadow maps after Enderton et al., I3D 2010.

void main()
{
#if defined(TRANSPARENT) && !defined(HOLDOUT)
  float through = closure_through(surface_closure());
  if (through > 0.0) {
    uvec2 texel = uvec2(gl_FragCoord.xy);
    uint seed = hash_combine(hash_uint(texel.x), texel.y);
    seed = hash_combine(seed, uint(instance_row));
    seed = hash_combine(seed, uint(gl_PrimitiveID));
    seed = hash_combine(seed, uint(sample_index) + 0x51ed270bu);
    if (hash_unit(seed) < through) {
      discard;
    }
  }
#endif
}
