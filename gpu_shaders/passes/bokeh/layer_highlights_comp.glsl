// Highlights of captured layers, a thread for each pixel of a layer that is one, or that dims one.
// LIST: appends them to the lists of their texels, as if they were fragments of surfaces, but for those
// that are hidden from the whole lens by what is right in front of them.
// SPLIT: writes into the layers what the lens samples keep of their light, as surface_frag does.
// WHOLE: writes all their light into the layers again.
// Inputs: place_tx (column, row, layer, value of the depth buffer), light_tx (radiance, coverage); first,
// number (of the pixels); LIST and SPLIT: highlight_buf, surroundings_tx, view_buf (of the layers' raster); LIST: front_tx
// (value of the depth buffer of the last pixel before it that hides what is behind it, 0: none, and the
// share that passes), what highlights_append needs; CHROMATIC: chromatic_buf, field_tx.
// Outputs: lists of fragments, or colors_img (premultiplied).
// Source: methods 9 (J20 section 4.1).
#include "lib/depth_lib.glsl"
#include "lib/lens_lib.glsl"
#include "lib/bokeh/fragment_list_lib.glsl"
#include "lib/bokeh/highlight_lib.glsl"
#if defined(LIST) || defined(SPLIT)
#include "lib/split/threshold_lib.glsl"
#endif
#ifdef LIST
#include "passes/bokeh/highlights_append.glsl"
#endif
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif

// Least coverage of a pixel that hides what is behind it.
#define OPAQUE_FROM 0.999
// Half precision ends there.
#define BRIGHTEST 65504.0
// Difference of circles of confusion, px, below which a surface in front hides from the whole lens; as in
// highlights_order_comp. From the other one on, visibility counts what covers a pixel in part.
#define SAME_VIEW 1.0
#define SAME_VIEW_IN_PART 0.25

#ifdef LIST
// Share of the light that passes what is right in front. `front`: its value of the depth buffer, and the
// share that passes it if nothing moves.
float passed_front(vec2 front, float window_depth)
{
  if (front.x <= 0.0) {
    return 1.0;
  }
  float near = depth_from_window(front.x, view_buf.projection, view_buf.lens);
  float far = (window_depth >= 1.0) ?
                  highlight_buf.world.x :
                  depth_from_window(window_depth, view_buf.projection, view_buf.lens);
  float parallax = coc_radius_px(near, view_buf.lens) - coc_radius_px(far, view_buf.lens);
  float same_view = (front.y > 0.0) ? SAME_VIEW_IN_PART : SAME_VIEW;
  return (abs(parallax) < same_view) ? front.y : 1.0;
}
#endif

#if defined(LIST) || defined(SPLIT)
float threshold_of(vec4 place)
{
  float depth = (place.w >= 1.0) ?
                    highlight_buf.world.x :
                    depth_from_window(place.w, view_buf.projection, view_buf.lens);
  vec2 clip = (place.xy + 0.5) / view_buf.film.xy * 2.0 - 1.0;
  return highlight_threshold(
      clip, coc_radius_px(depth, view_buf.lens), highlight_buf, surroundings_tx);
}
#endif

#ifdef SPLIT
// Share of the light above the threshold that is splatted.
float share_of(vec4 place)
{
  bool at_infinity = place.w >= 1.0;
  if (at_infinity && highlight_buf.world.y < 0.5) {
    return 0.0;
  }
  float depth = at_infinity ? highlight_buf.world.x :
                              depth_from_window(place.w, view_buf.projection, view_buf.lens);
#ifdef CHROMATIC
  vec2 clip = (place.xy + 0.5) / view_buf.film.xy * 2.0 - 1.0;
  vec2 shift = (view_buf.lens.y > 0.5) ? -view_buf.projection[3].xy : view_buf.projection[2].xy;
  vec2 scale = vec2(view_buf.projection[0][0], view_buf.projection[1][1]);
  float coc = chromatic_coc_px(
      field_tx, (clip + shift) / scale, depth, view_buf.lens, chromatic_buf);
  return highlight_share(coc, highlight_buf.split.y);
#else
  return at_infinity ? highlight_buf.world.z :
                       highlight_share(coc_radius_px(depth, view_buf.lens), highlight_buf.split.y);
#endif
}
#endif

void main()
{
  uint index = gl_GlobalInvocationID.x;
  if (index >= uint(number)) {
    return;
  }
  ivec2 texel = list_texel(uint(first) + index);
  vec4 place = texelFetch(place_tx, texel, 0);
  vec4 light = texelFetch(light_tx, texel, 0);
#ifdef LIST
  float passed = passed_front(texelFetch(front_tx, texel, 0).xy, place.w);
  if (passed <= 0.0) {
    return;
  }
  float threshold = threshold_of(place);
  vec3 above = passed * light.a * highlight_light(light.rgb, threshold, highlight_buf.split.z);
  bool opaque = light.a >= OPAQUE_FROM;
  if (opaque && max(above.r, max(above.g, above.b)) <= 0.0) {
    return;
  }
  append_fragment(ivec2(place.xy), above, place.w, opaque, 1.0 - light.a, 0u, threshold);
#else
#ifdef SPLIT
  light.rgb = highlight_base(light.rgb, share_of(place), threshold_of(place));
#endif
  vec4 color = clamp(vec4(light.rgb * light.a, light.a), -BRIGHTEST, BRIGHTEST);
  imageStore(colors_img, ivec3(ivec2(place.xy), int(place.z)), color);
#endif
}
