// One layer of what a pinhole at the lens' centre sees: the nearest surface behind the layer before.
// OCCLUDERS: of all surfaces, as their opacity. Otherwise of highlights alone, so that no number of
// dark surfaces in front makes a layer miss them; whether anything of the lens sees them is found
// later. Only what is hidden by a surface so close in front that no place on the lens looks behind
// it is left out here.
// Inputs: varyings of surface_vert; view_buf; front_tx (depth of the layer before); for highlights
// also front_color_tx (the layer before), scene_tx (depth of the nearest opaque surface) and
// highlight_buf; what the generated surface_closure() reads.
// Outputs: light above the threshold that would reach the eye through nothing else (rgb), opacity
// (a).
// Source: Everitt, Interactive order-independent transparency, 2001; methods 9.
#include "lib/depth_lib.glsl"
#include "lib/highlight_lib.glsl"
#include "lib/lens_lib.glsl"

// Circles of confusion that differ by less than this see the same surfaces in front, px.
#define SAME_VIEW 1.0
// Of a depth buffer: steps by which two shaders may differ in the depth of one surface.
#define DEPTH_STEPS 2e-7

#ifdef OCCLUDERS
void main()
{
  if (gl_FragCoord.z <= texelFetch(front_tx, ivec2(gl_FragCoord.xy), 0).x) {
    discard;
  }
  float opacity = 1.0;
#if defined(TRANSPARENT) && !defined(HOLDOUT)
  opacity = 1.0 - closure_through(surface_closure());
#ifdef OPAQUE_ONLY
  if (opacity < 0.999) {
    discard;
  }
#endif
  if (opacity <= 0.0) {
    discard;
  }
#endif
  out_color = vec4(0.0, 0.0, 0.0, opacity);
}
#else
// Whether an opaque surface in front hides what lies behind it from the whole lens.
bool hides(float front, float window_depth)
{
  float near = depth_from_window(front, view_buf.projection, view_buf.lens);
  float far = depth_from_window(window_depth, view_buf.projection, view_buf.lens);
  return abs(coc_radius_px(near, view_buf.lens) - coc_radius_px(far, view_buf.lens)) < SAME_VIEW;
}

void main()
{
#ifdef HOLDOUT
  discard;
#else
  ivec2 texel = ivec2(gl_FragCoord.xy);
  float z = gl_FragCoord.z;
  float front = texelFetch(front_tx, texel, 0).x;
  if (z <= front) {
    discard;
  }
  // Before the surface's own code, which may be long.
  float scene = texelFetch(scene_tx, texel, 0).x;
  if (scene < z - DEPTH_STEPS && hides(scene, z)) {
    discard;
  }
  if (texelFetch(front_color_tx, texel, 0).a >= 0.999 && hides(front, z)) {
    discard;
  }
  Closure closure = surface_closure();
  float opacity = 1.0;
  vec2 split = vec2(highlight_buf.split.x, highlight_buf.split.z);
  vec3 light = highlight_light(closure.radiance, closure.unsplit, split.x, split.y);
#ifdef TRANSPARENT
  opacity = 1.0 - closure_through(closure);
#ifndef GLOW_APART
  // What the lens samples split: the light of those that chance lets stand.
  float there = max(opacity, 1e-6);
  light = highlight_light(closure.radiance / there, closure.unsplit / there, split.x, split.y);
  light *= opacity;
#endif
#endif
  if (max(light.r, max(light.g, light.b)) <= 0.0) {
    discard;
  }
  out_color = vec4(light, opacity);
#endif
}
#endif
