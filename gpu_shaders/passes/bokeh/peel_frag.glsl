// Depth peeling from one place on the lens.
// OCCLUDERS: one layer of all surfaces, the nearest behind the previous layer, as their opacity.
// HIGHLIGHTS: all fragments above the highlight threshold, in lists for each texel, whatever is in
// front of them, and the depth of opaque surfaces.
// VEILS: see-through fragments that are not listed as highlights, added to the lists that there are,
// as they dim what lies right behind them.
// CANDIDATES: the tiles in which reflecting surfaces have highlights, or, without HIGHLIGHTS, in which
// there are any, whatever is in front of them.
// Otherwise: the depth of the nearest opaque surface.
// Inputs: varyings of surface_vert; view_buf; OCCLUDERS: front_tx (depth of the layer before);
// highlights: highlight_buf, surroundings_tx, REFLECTING: candidates_tx, areas_tx (of instances whose texels are counted; else 0) and what
// highlights_append needs; what the generated surface_closure()
// reads.
// Outputs: opacity (a); or lists of fragments (light above the threshold, not attenuated by surfaces in
// front) and hits_img (texels of each instance, hidden ones too); CANDIDATES (which reads means_tx): marks_img (bits of a
// threshold, by tile).
// Source: Everitt, Interactive order-independent transparency, 2001; Yang et al., Real-time
// concurrent linked list construction on the GPU, EGSR 2010; methods 9.
#include "lib/bokeh/hiding_lib.glsl"
#include "lib/bokeh/highlight_lib.glsl"
#ifdef HIGHLIGHTS
#include "lib/split/threshold_lib.glsl"
#ifdef CANDIDATES
#include "lib/split/means_lib.glsl"
#endif
#endif
#if defined(HIGHLIGHTS) && defined(REFLECTING)
#include "lib/bokeh/searched_lib.glsl"
#endif

#ifdef CANDIDATES
void main()
{
  float threshold = 1.0;
#ifdef HIGHLIGHTS
  vec3 point = (view_buf.view * vec4(world_position, 1.0)).xyz;
  vec2 at = place_in_search(vec4(point, 1.0), highlight_buf);
  float coc = coc_radius_px(-point.z, view_buf.lens);
  vec2 pixel = (at * 0.5 + 0.5) * highlight_buf.size.xy;
  int last = int(highlight_buf.automatic.y);
  if (hidden_from_lens(pixel, coc, ivec2(highlight_buf.size.xy), last, means_tx)) {
    discard;
  }
  threshold = highlight_threshold(at, coc, highlight_buf, surroundings_tx);
  Closure closure = surface_closure();
  float there = 1.0;
#if defined(TRANSPARENT) && !defined(GLOW_APART)
  there = max(1.0 - closure_through(closure), 1e-6);
#endif
  vec3 light = (closure.radiance - closure.unsplit) / there;
  if (max(light.r, max(light.g, light.b)) <= threshold) {
    discard;
  }
#endif
  imageAtomicMax(marks_img, ivec2(gl_FragCoord.xy) / tile_texels, floatBitsToUint(threshold));
}
#elif !defined(HIGHLIGHTS) && !defined(VEILS)
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

#ifdef HIGHLIGHTS
// The threshold of a surface; 0 where the lens samples keep all of its light, as surface_frag has it.
float threshold_here()
{
  vec3 point = (view_buf.view * vec4(world_position, 1.0)).xyz;
  vec2 at = place_in_search(vec4(point, 1.0), highlight_buf);
#ifdef REFLECTING
  vec3 normal = cross(dFdx(point), dFdy(point));
  if (seen_from_both_sides(point, normal, view_buf.lens, highlight_buf) ||
      !reflections_searched(at, highlight_buf, candidates_tx))
  {
    return 0.0;
  }
#endif
  return highlight_threshold(
      at, coc_radius_px(-point.z, view_buf.lens), highlight_buf, surroundings_tx);
}

// Light of a surface above a threshold of `threshold_here`.
vec3 listed_light(Closure closure, float opacity, float threshold)
{
  if (threshold <= 0.0) {
    return vec3(0.0);
  }
  vec2 split = vec2(threshold, highlight_buf.split.z);
#if defined(TRANSPARENT) && !defined(GLOW_APART)
  // As lens samples split it: the light of a surface that the random opacity keeps.
  float there = max(opacity, 1e-6);
  return opacity *
         highlight_light(closure.radiance / there, closure.unsplit / there, split.x, split.y);
#else
  return highlight_light(closure.radiance, closure.unsplit, split.x, split.y);
#endif
}
#endif

#ifdef VEILS
void main()
{
#ifdef HIGHLIGHTS
  float threshold = threshold_here();
#endif
  ivec2 texel = ivec2(gl_FragCoord.xy);
  if (imageLoad(heads_img, texel).x == 0u) {
    discard;
  }
#if defined(TRANSPARENT) && !defined(HOLDOUT)
  Closure closure = surface_closure();
  float opacity = 1.0 - closure_through(closure);
  bool veils = opacity > 0.0 && opacity < OPAQUE_FROM;
#ifdef HIGHLIGHTS
  vec3 light = listed_light(closure, opacity, threshold);
  veils = veils && max(light.r, max(light.g, light.b)) <= 0.0;
#endif
  if (veils) {
    append_fragment(texel, vec3(0.0), gl_FragCoord.z, false, 1.0 - opacity, 0u, 0.0);
  }
#endif
  // No depth.
  discard;
}
#else
void main()
{
  if (texelFetch(areas_tx, list_texel(uint(instance_row)), 0).x > 0.0) {
    imageAtomicAdd(hits_img, list_texel(uint(instance_row)), 1u);
  }
  Closure closure = surface_closure();
  float opacity = 1.0;
#ifdef TRANSPARENT
  opacity = 1.0 - closure_through(closure);
#endif
  float threshold = threshold_here();
  vec3 light = listed_light(closure, opacity, threshold);
  if (max(light.r, max(light.g, light.b)) > 0.0) {
    append_fragment(ivec2(gl_FragCoord.xy), light, gl_FragCoord.z, opacity >= OPAQUE_FROM,
                    1.0 - opacity, uint(instance_row) + 1u, threshold);
  }
#ifdef TRANSPARENT
  if (opacity < OPAQUE_FROM) {
    discard;
  }
#endif
}
#endif
#endif
