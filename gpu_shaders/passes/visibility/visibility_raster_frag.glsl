// Opaque triangles clear the mask.
// Inputs: v_tile (x, y, side of the mask, texels).
// Outputs: share of the light that passes.
// Source: methods 11.

void main()
{
  vec2 place = gl_FragCoord.xy - v_tile.xy;
  if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(v_tile.z)))) {
    discard;
  }
  out_mask = 0.0;
}
