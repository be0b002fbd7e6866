// One layer of the scene as a pinhole at the lens' centre sees it: the nearest surface behind the
// layer before, as the light above the threshold and how much it hides.
// Inputs: varyings of surface_vert; view_buf; highlight_buf; front_tx (depth of the layer before);
// what the generated surface_closure() reads.
// Outputs: light above the threshold that reaches the eye through nothing else (rgb), opacity (a).
// Source: Everitt, Interactive order-independent transparency, 2001; methods 9.
#include "lib/highlight_lib.glsl"

void main()
{
  if (gl_FragCoord.z <= texelFetch(front_tx, ivec2(gl_FragCoord.xy), 0).x) {
    discard;
  }
#ifdef HOLDOUT
  out_color = vec4(0.0, 0.0, 0.0, 1.0);
#else
  Closure closure = surface_closure();
#ifdef TRANSPARENT
  float opacity = 1.0 - closure_through(closure);
#ifdef GLOW_APART
  // Light that is added, as the lens samples split it.
  vec3 excess = highlight_excess(closure.radiance, highlight_buf.split.x);
#else
  vec3 whole = closure.radiance / max(opacity, 1e-6);
  vec3 excess = highlight_excess(whole, highlight_buf.split.x) * opacity;
#endif
  if (opacity <= 0.0 && max(excess.r, max(excess.g, excess.b)) <= 0.0) {
    discard;
  }
  out_color = vec4(excess, opacity);
#else
  out_color = vec4(highlight_excess(closure.radiance, highlight_buf.split.x), 1.0);
#endif
#endif
}
