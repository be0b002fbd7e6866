// Shades a surface for one lens sample; transparency is decided by chance, so that the average over
// the samples is exact whatever the order of the surfaces.
// Inputs: varyings of surface_vert; view_buf; what the generated surface_closure() reads.
// Outputs: premultiplied scene-linear colour.
// Source: methods 1; stochastic transparency after Enderton et al., I3D 2010.

void main()
{
#ifdef HOLDOUT
  out_color = vec4(0.0);
#else
  Closure closure = surface_closure();
#ifdef TRANSPARENT
  float through = clamp(dot(closure.transmittance, vec3(1.0 / 3.0)), 0.0, 1.0);
  if (through > 0.0) {
    uint seed = hash_combine(hash_uint(uint(gl_FragCoord.x)), uint(gl_FragCoord.y));
    seed = hash_combine(seed, uint(instance_row));
    seed = hash_combine(seed, uint(gl_PrimitiveID));
    seed = hash_combine(seed, uint(sample_index));
    if (hash_unit(seed) < through) {
      discard;
    }
    closure.radiance /= max(1.0 - through, 1e-6);
  }
#endif
  out_color = vec4(closure.radiance, 1.0);
#endif
}
