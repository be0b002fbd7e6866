// What a pinhole on the lens sees, beyond the nearest surface.
// OCCLUDERS: one layer of all surfaces, the nearest behind the layer before, as their opacity.
// HIGHLIGHTS: all that is brighter than the threshold, in lists for each texel, so that no surface in
// front makes it miss any, and the depth of what is opaque.
// Otherwise: the depth of the nearest opaque surface.
// Inputs: varyings of surface_vert; view_buf; OCCLUDERS: front_tx (depth of the layer before);
// highlights: highlight_buf, areas_tx (of instances whose texels are counted; else 0) and what
// highlights_append needs; what the generated surface_closure()
// reads.
// Outputs: opacity (a); or lists of fragments: light above the threshold that would reach the eye
// through nothing else, and hits_img (texels of each instance, whatever hides them).
// Source: Everitt, Interactive order-independent transparency, 2001; Yang et al., Real-time
// concurrent linked list construction on the GPU, EGSR 2010; methods 9.
#include "lib/bokeh/highlight_lib.glsl"

// Less is seen through.
#define OPAQUE_FROM 0.999

#ifndef HIGHLIGHTS
void main()
{
#ifdef OCCLUDERS
  if (gl_FragCoord.z <= texelFetch(front_tx, ivec2(gl_FragCoord.xy), 0).x) {
    discard;
  }
#endif
  float opacity = 1.0;
#if defined(TRANSPARENT) && !defined(HOLDOUT)
  opacity = 1.0 - closure_through(surface_closure());
#ifndef OCCLUDERS
  if (opacity < OPAQUE_FROM) {
    discard;
  }
#endif
  if (opacity <= 0.0) {
    discard;
  }
#endif
#ifdef OCCLUDERS
  out_color = vec4(0.0, 0.0, 0.0, opacity);
#endif
}
#else
#include "passes/bokeh/highlights_append.glsl"

void main()
{
  if (texelFetch(areas_tx, list_texel(uint(instance_row)), 0).x > 0.0) {
    imageAtomicAdd(hits_img, list_texel(uint(instance_row)), 1u);
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
  if (max(light.r, max(light.g, light.b)) > 0.0) {
    append_fragment(ivec2(gl_FragCoord.xy), light, gl_FragCoord.z, opacity >= OPAQUE_FROM,
                    uint(instance_row) + 1u);
  }
#ifdef TRANSPARENT
  if (opacity < OPAQUE_FROM) {
    discard;
  }
#endif
}
#endif
