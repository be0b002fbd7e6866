// Parallax of an occluder across a merged source: how far its shadow on the lens is blurred.
#ifndef OCCLUDER_BLUR_LIB_GLSL
#define OCCLUDER_BLUR_LIB_GLSL
#include "lib/bokeh/source_lib.glsl"

// Largest blur, radii of the lens: wider than the lens, more makes no difference.
#define WIDEST_BLUR 2.0

// Side of the square on the lens, in its radii, that the shadow of an occluder at depth z (m) is
// blurred over. A part that the picture shows e px away sees the lens through an occluder as if that
// were shifted by
//   e (1 - z (d - f) / ((d - z) f)) px        (orthographic: e (1 - (d - f) / (d - z)))
// for the depths d of the source, z of the occluder and f of the focus: hardly in front of the
// source, its shadow moves across the whole lens.
// `extent`: of the source, px.
// Source: J-D equation 5.4, with each occluder's own depth.
float occluder_blur(Source source, float extent, float z, VisibilityParams params)
{
  float d = source.cone.depth, focus = params.colors.w;
  vec4 lens = vec4(focus, params.lens.yzw);
  // The lens may focus some wavelengths there.
  float coc = max(abs(coc_radius_px(d, lens)), 0.1);
  float gamma = (d - focus) / max(d - z, 1e-6 * d);
  gamma *= (lens.y > 0.5) ? 1.0 : z / focus;
  return min(extent * abs(1.0 - gamma) / coc, WIDEST_BLUR);
}

#endif
