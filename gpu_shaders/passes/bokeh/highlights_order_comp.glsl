// Sorts the fragments of each texel from front to back and drops those hidden from the whole lens:
// right behind an opaque surface or an opaque highlight. All others stay, whatever is in front: their
// visibility from each part of the lens is found later, but for see-through fragments right in front,
// which the lens sees in front of them from everywhere: these dim them here. See-through fragments
// with nearly one circle of confusion are put at the depth of the first, as one highlight will be made
// of them and its visibility must not count its own fragments.
// A thread for each fragment; the thread of a texel's last fragment sorts the texel.
// Inputs: nodes_tx, heads_img, light_img (see highlights_append; fragments without light only dim); scene_tx (window depth of the
// nearest opaque surface); areas_tx and hits_tx (of each instance: area in the raster, 0 where it is
// not known, its growth over the lens, and number of its texels in the raster); view_buf (of the raster), highlight_buf; number (of fragments); layers
// (that are kept of a texel, one for all see-through fragments that are put at one depth); same_view
// (parallax, px, from which on visibility counts a surface in front). WORLD: the world at infinity, nothing in front. CHROMATIC: chromatic_buf,
// field_tx (field table) and lens_view (xy: place on the lens that the raster was seen from, m).
// Outputs: heads_img (first of a texel, with IN_ORDER), order_img (next of each); light_img: light that
// is splatted (0 where the circle of confusion is too small) and depth along the axis, m.
// Source: methods 9 (J20 section 4.1).
#include "lib/bokeh/fragment_list_lib.glsl"
#include "lib/bokeh/hiding_lib.glsl"
#include "lib/bokeh/highlight_lib.glsl"
#include "lib/bokeh/visibility_lib.glsl"
#include "lib/lens_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif

// Difference of circles of confusion, px, below which see-through fragments are put at one depth: a little more than what
// highlights_comp makes one highlight of, so that no rounding joins two of them there.
#define ONE_PLACE 1.05

float depth_of(float window_depth)
{
  return depth_from_window(window_depth, view_buf.projection, view_buf.lens);
}

float largest(vec3 color)
{
  return max(color.r, max(color.g, color.b));
}

// Whether see-through fragments are put at one depth.
bool at_one_place(float front, float window_depth)
{
  float near = coc_radius_px(depth_of(front), view_buf.lens);
  float far = coc_radius_px(depth_of(window_depth), view_buf.lens);
  return abs(near - far) < ONE_PLACE;
}

#ifndef WORLD
struct Fragment {
  uint number;  // 0 is none
  vec4 light;
  bool opaque;
};

// The nearest fragment behind `front` that is not hidden from the whole lens. Of two at one depth, the
// brighter.
Fragment next_behind(uint first, Fragment front, float scene)
{
  Fragment best = Fragment(0u, vec4(0.0, 0.0, 0.0, 2.0), false);
  for (uint number = first; number != 0u;) {
    ivec2 place = list_texel(number - 1u);
    uvec2 node = texelFetch(nodes_tx, place, 0).xy;
    vec4 light = imageLoad(light_img, place);
    bool nearer = light.a < best.light.a;
    nearer = nearer || (light.a == best.light.a && largest(light.rgb) > largest(best.light.rgb));
    bool hidden = hides(scene, light.a, view_buf.projection, view_buf.lens);
    hidden = hidden ||
             (front.opaque && alike(front.light.a, light.a, view_buf.projection, view_buf.lens));
    if (light.a > front.light.a && nearer && !hidden && largest(light.rgb) > 0.0) {
      best = Fragment(number, light, (node.x & KEY_OPAQUE) != 0u);
    }
    number = node.y;
  }
  return best;
}
#endif

#ifndef WORLD
bool any_see_through(uint first)
{
  for (uint number = first; number != 0u;) {
    uvec2 node = texelFetch(nodes_tx, list_texel(number - 1u), 0).xy;
    if ((node.x & KEY_OPAQUE) == 0u) {
      return true;
    }
    number = node.y;
  }
  return false;
}

// Share of a fragment's light that passes the see-through fragments in front of it, as far as
// visibility does not count them for a highlight at the depth `place`.
float passed(uint first, float window_depth, float place)
{
  float hiding = hiding_depth(depth_of(place), view_buf.lens, same_view);
  float through = 1.0;
  for (uint number = first; number != 0u;) {
    ivec2 texel = list_texel(number - 1u);
    uvec4 node = texelFetch(nodes_tx, texel, 0);
    float before = imageLoad(light_img, texel).a;
    if ((node.x & KEY_OPAQUE) == 0u && before < window_depth && depth_of(before) > hiding) {
      through *= uintBitsToFloat(node.w);
    }
    number = node.y;
  }
  return through;
}

// Depth at which a fragment is put. `place`: that of the fragment before it; `joinable`: there is one,
// and it is see-through.
float layer_place(float place, bool joinable, float window_depth)
{
  return (joinable && at_one_place(place, window_depth)) ? place : window_depth;
}

// Dims the fragments of a texel by those in front, all before any depth is changed.
void dim(uint first, uint start)
{
  float place = 0.0;
  bool joinable = false;
  for (uint kept = start; kept != 0u;) {
    ivec2 at = list_texel(kept - 1u);
    vec4 light = imageLoad(light_img, at);
    place = layer_place(place, joinable, light.a);
    joinable = (texelFetch(nodes_tx, at, 0).x & KEY_OPAQUE) == 0u;
    light.rgb *= passed(first, light.a, place);
    imageStore(light_img, at, light);
    kept = imageLoad(order_img, at).x;
  }
}

// Factor of the light of an instance's texels: its area in the raster over its number of texels, times
// its area over the lens relative to that from the middle.
float area_per_hit(uint instance)
{
  if (instance == 0u) {
    return 1.0;
  }
  vec2 area = texelFetch(areas_tx, list_texel(instance - 1u), 0).xy;
  uint hits = texelFetch(hits_tx, list_texel(instance - 1u), 0).x;
  return area.y * ((area.x > 0.0 && hits > 0u) ? area.x / float(hits) : 1.0);
}
#endif

#ifdef CHROMATIC
// Radius of the circle of confusion that represents all wavelengths, px, at the place in the field from
// which a texel's light comes.
float typical_coc(ivec2 texel, float depth)
{
  vec2 clip = (vec2(texel) + 0.5) / view_buf.film.xy * 2.0 - 1.0;
  vec2 scale = vec2(view_buf.projection[0][0], view_buf.projection[1][1]);
  vec2 xy = (view_buf.lens.y > 0.5) ? (clip - view_buf.projection[3].xy) / scale :
                                      (clip + view_buf.projection[2].xy) / scale * depth;
  xy += lens_view.xy * (view_buf.lens.x - depth) / view_buf.lens.x;
  vec2 place = field_place(vec3(xy, -depth), chromatic_buf);
  return chromatic_coc_px(field_tx, place, depth, view_buf.lens, chromatic_buf);
}
#endif

// The light of a fragment that is splatted, and its depth.
vec4 splatted(vec4 light, ivec2 texel)
{
#ifdef WORLD
  float depth = highlight_buf.world.x;
#else
  float depth = depth_of(light.a);
#endif
#ifdef CHROMATIC
  float share = highlight_share(typical_coc(texel, depth), highlight_buf.split.y);
#elif defined(WORLD)
  float share = highlight_buf.world.z;
#else
  float share = highlight_share(coc_radius_px(depth, view_buf.lens), highlight_buf.split.y);
#endif
  return vec4(light.rgb * share, depth);
}

void main()
{
  uint threads = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  uint index = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * threads;
  if (index >= uint(number)) {
    return;
  }
  uvec2 node = texelFetch(nodes_tx, list_texel(index), 0).xy;
  ivec2 texel = key_texel(node.x);
  uint first = imageLoad(heads_img, texel).x;
  if (first != index + 1u) {
    return;
  }
#ifdef WORLD
  uint start = first;
  imageStore(order_img, list_texel(index), uvec4(0u));
#else
  float scene = texelFetch(scene_tx, texel, 0).x;
  Fragment front = Fragment(0u, vec4(0.0), false);
  uint start = 0u;
  // Of the first fragment of a layer.
  float place = 0.0;
  for (int layer = 0;;) {
    Fragment next = next_behind(first, front, scene);
    if (next.number == 0u) {
      break;
    }
    bool joinable = front.number != 0u && !front.opaque;
    float to = layer_place(place, joinable, next.light.a);
    bool joins = joinable && to == place;
    if (!joins && layer == layers) {
      break;
    }
    layer += joins ? 0 : 1;
    place = to;
    if (front.number == 0u) {
      start = next.number;
    }
    else {
      imageStore(order_img, list_texel(front.number - 1u), uvec4(next.number));
    }
    front = next;
    if (node.y == 0u) {
      break;
    }
  }
  if (front.number != 0u) {
    imageStore(order_img, list_texel(front.number - 1u), uvec4(0u));
  }
  if (node.y != 0u && any_see_through(first)) {
    dim(first, start);
  }
#endif
  imageStore(heads_img, texel, uvec4(start | IN_ORDER));
#ifndef WORLD
  bool joinable = false;
#endif
  for (uint kept = start; kept != 0u;) {
    ivec2 at = list_texel(kept - 1u);
    vec4 light = imageLoad(light_img, at);
#ifndef WORLD
    uvec4 own = texelFetch(nodes_tx, at, 0);
    light.rgb *= area_per_hit(own.z);
    place = layer_place(place, joinable, light.a);
    joinable = (own.x & KEY_OPAQUE) == 0u;
    light.a = place;
#endif
    imageStore(light_img, at, splatted(light, texel));
    kept = imageLoad(order_img, at).x;
  }
}
