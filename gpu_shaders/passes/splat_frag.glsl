// A highlight's disc; the blend state adds it to the others.
// Inputs: v_place, v_density, v_blur (see splat_vert); opening_tx (layers of rising blur).
// Outputs: scene-linear light.
// Source: methods 13.
#include "lib/opening_lib.glsl"

void main()
{
  out_color = vec4(v_density * opening_density(opening_tx, v_place, v_blur), 0.0);
}
