// Shades a surface for one lens sample, with stochastic transparency: the average over the samples is
// exact whatever the order of the surfaces. A transparent surface that emits is drawn twice: its random
// opacity without its light (GLOW_APART), then its light on top (GLOW), wherever nothing is in front.
// One that lets colours through unevenly is drawn again, too (FILTER): where it was seen through, what was
// seen is multiplied by the colour over its mean.
// Inputs: varyings of surface_vert; view_buf; what the generated surface_closure() reads. HIGHLIGHTS:
// highlight_buf, surroundings_tx, REFLECTING: candidates_tx; the light that is splatted as bokeh is left out; with CHROMATIC also chromatic_buf and
// field_tx, so that the splatted share is the same at all wavelengths; with MIRRORING it is searched
// from several places on the lens, with REFLECTING only where the whole lens sees one side. OF_LAYER:
// front_tx (depths that it must lie behind) and eye (place on the lens that it is shaded for, m). LENS_BLUR:
// real_lens_buf, blur_tx (what the lens adds to the circle of confusion).
// Outputs: premultiplied scene-linear colour; with MATTES also Cryptomatte ids of object (x) and
// material (y), and the focus matte (w).
// Source: methods 1; stochastic transparency after Enderton et al., I3D 2010.

#ifdef MATTES
#include "lib/surface/instance_lib.glsl"
#endif
#if defined(MATTES) || defined(HIGHLIGHTS)
#include "lib/lens_lib.glsl"
#endif
#ifdef LENS_BLUR
#include "lib/real_lens_lib.glsl"
#endif
#ifdef HIGHLIGHTS
#include "lib/bokeh/highlight_lib.glsl"
#include "lib/bokeh/searched_lib.glsl"
#include "lib/split/threshold_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif

// What lens samples keep of a point's light. `point`, `normal`: in camera space, its true place, not where
// the wavelength displaces it to; `at`: as of `place_in_search`.
vec3 kept_light(Closure closure, vec3 point, vec3 normal, vec2 at)
{
  float middle_coc = coc_radius_px(-point.z, view_buf.lens);
  float threshold = highlight_threshold(at, middle_coc, highlight_buf, surroundings_tx);
#ifdef CHROMATIC
  vec2 place = field_place(point, chromatic_buf);
  float coc = chromatic_coc_px(field_tx, place, -point.z, view_buf.lens, chromatic_buf);
#else
  float coc = middle_coc;
#endif
  float share = highlight_share(coc, highlight_buf.split.y);
#ifdef REFLECTING
  if (seen_from_both_sides(point, normal, view_buf.lens, highlight_buf)) {
    return closure.radiance;
  }
#endif
#ifndef MIRRORING
  share *= searched(vec4(point, 1.0), highlight_buf);
#elif defined(OF_LAYER)
  share *= searched_from_views(point, eye, view_buf.lens.x, highlight_buf);
#else
  share *= searched_from_views(point, lens_sample.xy, view_buf.lens.x, highlight_buf);
#endif
  return highlight_base(closure.radiance, closure.unsplit, share, threshold);
}

vec3 without_highlights(Closure closure)
{
  vec3 light = closure.radiance - closure.unsplit;
  vec3 point = (view_buf.view * vec4(world_position, 1.0)).xyz;
  vec3 normal = cross(dFdx(point), dFdy(point));
  if (max(light.r, max(light.g, light.b)) <= highlight_buf.split.x) {
    return closure.radiance;
  }
  vec2 at = place_in_search(vec4(point, 1.0), highlight_buf);
#ifdef REFLECTING
  if (!reflections_searched(at, highlight_buf, candidates_tx)) {
    return closure.radiance;
  }
#endif
  return kept_light(closure, point, normal, at);
}
#endif

#ifdef TRANSPARENT
// Whether this lens sample sees through the surface. Each surface of a pixel has a sequence of its own over
// the samples, evenly spread: far less noise than independent decisions.
bool seen_through(float through)
{
  uvec2 pixel = uvec2(gl_FragCoord.xy) + uvec2(view_buf.film.zw);
  uint seed = hash_combine(hash_uint(pixel.x), pixel.y);
  seed = hash_combine(seed, uint(instance_row));
  seed = hash_combine(seed, uint(gl_PrimitiveID));
  return through > 0.0 && hash_spread(uint(sample_index), seed) < through;
}
#endif

void main()
{
#ifdef OF_LAYER
  if (gl_FragCoord.z <= texelFetch(front_tx, ivec2(gl_FragCoord.xy), 0).x) {
    discard;
  }
#endif
#ifdef HOLDOUT
  out_color = vec4(0.0);
#ifdef MATTES
  out_mattes = vec4(0.0);
#endif
#else
  Closure closure = surface_closure();
#ifdef FILTER
  float through = closure_through(closure);
  if (!seen_through(through)) {
    discard;
  }
  out_color = vec4(closure.transmittance / through, 1.0);
#ifdef MATTES
  out_mattes = vec4(1.0);
#endif
#elif defined(GLOW)
#ifdef HIGHLIGHTS
  closure.radiance = without_highlights(closure) + closure.shift;
#endif
  out_color = vec4(closure.radiance, 0.0);
#ifdef MATTES
  out_mattes = vec4(0.0);
#endif
#else
  float hole = clamp(closure.holdout, 0.0, 1.0);
#ifdef TRANSPARENT
#ifdef GLOW_APART
  closure.radiance = vec3(0.0);
  closure.unsplit = vec3(0.0);
  closure.shift = vec3(0.0);
#endif
  float through = closure_through(closure);
  if (seen_through(through)) {
    discard;
  }
  if (through > 0.0) {
    // A sample that keeps the surface represents its whole light.
    float scale = 1.0 / max(1.0 - through, 1e-6);
    closure.radiance *= scale;
    closure.unsplit *= scale;
    closure.shift *= scale;
    hole = min(hole * scale, 1.0);
  }
#endif
#ifdef HIGHLIGHTS
  closure.radiance = without_highlights(closure) + closure.shift;
#endif
  out_color = vec4(closure.radiance, 1.0 - hole);
#ifdef MATTES
  vec3 point = (view_buf.view * vec4(world_position, 1.0)).xyz;
  float coc = coc_radius_px(-point.z, view_buf.lens);
#ifdef LENS_BLUR
  coc += real_lens_blur(blur_tx, point, real_lens_buf);
#endif
  float object_id = texelFetch(instances_tx, instance_texel(instance_row, 3), 0).x;
  float sharp = focus_share(coc, view_buf.lens.w);
  out_mattes = vec4(object_id, material_id, 0.0, sharp);
#endif
#endif
#endif
}
