// Opaque surfaces behind the nearest one: they take the light of listed fragments that they hide from
// the whole lens. What the nearest surface hides is found when fragments are sorted.
// Inputs: varyings of surface_vert; view_buf; heads_img, nodes_img (see highlights_append); what the
// generated surface_closure() reads of a transparent surface.
// Outputs: light_img (light 0 where it is hidden; the order of surfaces does not matter).
// Source: methods 9 (J20 section 4.1).
#include "lib/bokeh/fragment_list_lib.glsl"
#include "lib/bokeh/hiding_lib.glsl"

void main()
{
#if defined(TRANSPARENT) && !defined(HOLDOUT)
  if (1.0 - closure_through(surface_closure()) < OPAQUE_FROM) {
    discard;
  }
#endif
  for (uint number = imageLoad(heads_img, ivec2(gl_FragCoord.xy)).x; number != 0u;) {
    ivec2 place = list_texel(number - 1u);
    float behind = imageLoad(light_img, place).a;
    if (hides(gl_FragCoord.z, behind, view_buf.projection, view_buf.lens)) {
      imageStore(light_img, place, vec4(0.0, 0.0, 0.0, behind));
    }
    number = imageLoad(nodes_img, place).y;
  }
  // No depth.
  discard;
}
