// Depth peeling from one place on the lens.
// OCCLUDERS: one layer of all surfaces, the nearest behind the previous layer, as their opacity.
// HIGHLIGHTS: all fragments above the highlight threshold, in lists for each texel, whatever is in
// front of them, and the depth of opaque surfaces.
// VEILS: see-through fragments that are not listed as highlights, added to the lists that there are,
// as they dim what lies right behind them.
// Otherwise: the depth of the nearest opaque surface.
// Inputs: varyings of surface_vert; view_buf; OCCLUDERS: front_tx (depth of the layer before);
// highlights: highlight_buf, areas_tx (of instances whose texels are counted; else 0) and what
// highlights_append needs; what the generated surface_closure()
// reads.
// Outputs: opacity (a); or lists of fragments (light above the threshold, not attenuated by surfaces in
// front) and hits_img (texels of each instance, hidden ones too).
// Source: Everitt, Interactive order-independent transparency, 2001; Yang et al., Real-time
// concurrent linked list construction on the GPU, EGSR 2010; methods 9.
#include "lib/bokeh/hiding_lib.glsl"
#include "lib/bokeh/highlight_lib.glsl"
#if defined(HIGHLIGHTS) && defined(REFLECTING)
#include "lib/bokeh/searched_lib.glsl"
#endif

#if !defined(HIGHLIGHTS) && !defined(VEILS)
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
// Whether the lens samples keep all of a surface's light, as surface_frag has it.
bool is_left()
{
#ifdef REFLECTING
  vec3 point = (view_buf.view * vec4(world_position, 1.0)).xyz;
  vec3 normal = cross(dFdx(point), dFdy(point));
  return seen_from_both_sides(point, normal, view_buf.lens, highlight_buf);
#else
  return false;
#endif
}

// Light above the threshold of a surface.
vec3 listed_light(Closure closure, float opacity, bool left)
{
  if (left) {
    return vec3(0.0);
  }
  vec2 split = vec2(highlight_buf.split.x, highlight_buf.split.z);
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
  bool left = is_left();
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
  vec3 light = listed_light(closure, opacity, left);
  veils = veils && max(light.r, max(light.g, light.b)) <= 0.0;
#endif
  if (veils) {
    append_fragment(texel, vec3(0.0), gl_FragCoord.z, false, 1.0 - opacity, 0u);
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
  vec3 light = listed_light(closure, opacity, is_left());
  if (max(light.r, max(light.g, light.b)) > 0.0) {
    append_fragment(ivec2(gl_FragCoord.xy), light, gl_FragCoord.z, opacity >= OPAQUE_FROM,
                    1.0 - opacity, uint(instance_row) + 1u);
  }
#ifdef TRANSPARENT
  if (opacity < OPAQUE_FROM) {
    discard;
  }
#endif
}
#endif
#endif
