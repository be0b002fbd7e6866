// The world background at infinity, seen from one place on the lens, where no surface is.
// Inputs: view_buf; lens_sample (xy: place on the lens, m; zw: sub-pixel jitter in clip units);
// environment_buf; environment_tx (equirectangular, scene linear). HIGHLIGHTS: highlight_buf, surroundings_tx; the light
// that is splatted as bokeh is left out. EXCESS: highlight_buf, surroundings_tx, through_tx (share of the light that
// passes what covers the world from the whole lens) and the inputs of highlights_append; light above the
// threshold is listed.
// CHROMATIC, REAL_LENS: as in surface_vert.
// Outputs: opaque scene-linear colour; with EXCESS lists of fragments: light above the threshold.
// Source: methods 1: the ray from the lens' place through the pixel's point of the focus plane.
#include "lib/surface/environment_lib.glsl"
#include "lib/surface/texture_lib.glsl"
#if defined(HIGHLIGHTS) || defined(EXCESS) || defined(CHROMATIC)
#include "lib/lens_lib.glsl"
#endif
#if defined(HIGHLIGHTS) || defined(EXCESS)
#include "lib/bokeh/highlight_lib.glsl"
#include "lib/split/threshold_lib.glsl"
#endif
#ifdef HIGHLIGHTS
#include "lib/bokeh/searched_lib.glsl"
#endif
#ifdef EXCESS
#include "passes/bokeh/highlights_append.glsl"
#endif
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif
#ifdef REAL_LENS
#include "lib/real_lens_lib.glsl"
#endif
#if defined(CHROMATIC) || defined(REAL_LENS)

// Steps of the search for the place in the field that the lens moves to the pixel's place.
#define ITERATIONS 4
#endif

void main()
{
  vec2 clip = gl_FragCoord.xy / view_buf.film.xy * 2.0 - 1.0 - lens_sample.zw;
  vec3 direction = vec3(0.0, 0.0, -1.0);
  if (view_buf.lens.y < 0.5) {
    // Where the pinhole's ray is at a depth of 1 m, where w is 1.
    direction.xy = (clip + vec2(view_buf.projection[2][0], view_buf.projection[2][1])) /
                   vec2(view_buf.projection[0][0], view_buf.projection[1][1]);
  }
#ifdef CHROMATIC
  vec2 pixel = direction.xy;
  vec2 place = pixel;
  if (view_buf.lens.y > 0.5) {
    // All rays are parallel: the world has no size that a wavelength could change.
    place = gl_FragCoord.xy * chromatic_buf.raster.xy + chromatic_buf.raster.zw;
    vec2 strengths = field_strengths(field_tx, place, chromatic_buf);
    float focus = chromatic_focus(dispersion.x, strengths.x, chromatic_buf);
    direction.xy -= lens_sample.xy * focus;
  }
  else {
    for (int i = 0; i < ITERATIONS; i++) {
      vec2 strengths = field_strengths(field_tx, place, chromatic_buf);
      float focus = chromatic_focus(dispersion.x, strengths.x, chromatic_buf);
      float scale = lateral_scale(dispersion.y, strengths.y, chromatic_buf);
#ifdef REAL_LENS
      vec2 shift = real_lens_move(moves_tx, place, 0.0, lens_slot, real_lens_buf);
      place = (pixel - shift - lens_sample.xy * focus) / scale;
#else
      place = (pixel - lens_sample.xy * focus) / scale;
#endif
    }
    direction.xy = place;
  }
#else
  direction.xy -= lens_sample.xy / view_buf.lens.x;
#ifdef REAL_LENS
  vec2 pixel = direction.xy;
  for (int i = 0; i < ITERATIONS; i++) {
    direction.xy = pixel - real_lens_move(moves_tx, direction.xy, 0.0, lens_slot, real_lens_buf);
  }
#endif
#endif
#ifdef HIGHLIGHTS
  float in_raster = searched(vec4(direction, 0.0), highlight_buf);
#endif
#if defined(HIGHLIGHTS) || defined(EXCESS)
  float threshold = highlight_threshold(place_in_search(vec4(direction, 0.0), highlight_buf),
                                        coc_radius_px(highlight_buf.world.x, view_buf.lens),
                                        highlight_buf, surroundings_tx);
#endif
  direction = mat3(view_buf.view_inverse) * direction;
  vec3 local = vec3(dot(environment_buf.rotation_x.xyz, direction),
                    dot(environment_buf.rotation_y.xyz, direction),
                    dot(environment_buf.rotation_z.xyz, direction));
  vec3 radiance = image_linear(environment_tx, direction_to_equirect(local), EXTENSION_REPEAT).rgb;
  radiance *= environment_buf.color.rgb;
#ifdef HIGHLIGHTS
#ifdef CHROMATIC
  float coc = chromatic_coc_px(field_tx, place, highlight_buf.world.x, view_buf.lens, chromatic_buf);
  float share = highlight_buf.world.y * highlight_share(coc, highlight_buf.split.y);
#else
  float share = highlight_buf.world.z;
#endif
  radiance = highlight_base(radiance, share * in_raster, threshold);
#endif
#ifdef EXCESS
  vec3 light = highlight_light(radiance, threshold, highlight_buf.split.z);
  light *= texelFetch(through_tx, ivec2(gl_FragCoord.xy), 0).x;
  if (max(light.r, max(light.g, light.b)) > 0.0) {
    append_fragment(ivec2(gl_FragCoord.xy), light, 1.0, true, 0.0, 0u, threshold);
  }
#else
  out_color = vec4(radiance, 1.0);
#endif
}
