// Highlights of the pixels of a raster. First they are counted for each pixel; after prefix sums
// (prefix_sums_comp) have given each pixel's place in the list, EMIT writes them.
// The fragments of a pixel make one highlight, or several where their depths, and with them their
// circles of confusion, differ.
// A group of threads for each tile that has fragments.
// Inputs: listed_tx (tiles: x, y); heads_tx, order_tx, light_tx (see highlights_order_comp); view_buf
// (of the raster); tiles (how many), subpixels (along a side of a pixel); with EMIT starts_tx and
// totals_tx (prefix sums of what was counted), first (highlights listed before) and lens_view (xy:
// place on the lens that it was seen from, m; z: region of the lens that it stands for).
// Outputs: starts_img (highlights of each pixel, tile by tile) and sharp_img (pixels with fragments
// whose circle of confusion is too small to be splatted); EMIT fills a_img (x, y and depth in camera
// space, m; side of the square it stands for, px) and b_img (energy: radiance times pixels; region of
// the lens).
// Source: methods 9 (J20 section 4.1).
#include "lib/bokeh/fragment_list_lib.glsl"
#include "lib/lens_lib.glsl"

// Largest difference of circles of confusion that are averaged, px.
#define COC_TOLERANCE 1.0
// Most highlights of a pixel; the last one has all the light that is left.
#define MOST 8u

float largest(vec3 color)
{
  return max(color.r, max(color.g, color.b));
}

uint first_of(ivec2 texel)
{
  return texelFetch(heads_tx, texel, 0).x & ~IN_ORDER;
}

uint next_of(uint number)
{
  return texelFetch(order_tx, list_texel(number - 1u), 0).x;
}

// Least circle of confusion, from `from` on, of a pixel's fragments, and the largest; the largest is
// below the least where there are no fragments.
vec2 coc_range(ivec2 pixel, float from, out bool sharp)
{
  vec2 range = vec2(1e30, -1e30);
  sharp = false;
  for (int i = 0; i < subpixels * subpixels; i++) {
    ivec2 texel = pixel * subpixels + ivec2(i % subpixels, i / subpixels);
    for (uint number = first_of(texel); number != 0u; number = next_of(number)) {
      vec4 light = texelFetch(light_tx, list_texel(number - 1u), 0);
      float coc = coc_radius_px(light.a, view_buf.lens);
      if (largest(light.rgb) <= 0.0) {
        sharp = true;
      }
      else if (coc >= from) {
        range = vec2(min(range.x, coc), max(range.y, coc));
      }
    }
  }
  return range;
}

#ifdef EMIT
struct Highlight {
  vec3 energy;
  float weight;
  vec2 place;           // weighted, in texels
  float inverse_depth;  // weighted
  float texels;
};

// The light of a pixel whose circles of confusion lie in [from, to).
Highlight gather(ivec2 pixel, float from, float to)
{
  Highlight found = Highlight(vec3(0.0), 0.0, vec2(0.0), 0.0, 0.0);
  for (int i = 0; i < subpixels * subpixels; i++) {
    ivec2 texel = pixel * subpixels + ivec2(i % subpixels, i / subpixels);
    float covered = 0.0;
    for (uint number = first_of(texel); number != 0u; number = next_of(number)) {
      vec4 light = texelFetch(light_tx, list_texel(number - 1u), 0);
      float coc = coc_radius_px(light.a, view_buf.lens);
      if (coc >= from && coc < to) {
        // Fragments that are too sharp to be splatted are left out.
        float weight = largest(light.rgb);
        found.energy += light.rgb;
        found.weight += weight;
        found.place += (vec2(texel) + 0.5) * weight;
        found.inverse_depth += weight / light.a;
        covered = (weight > 0.0) ? 1.0 : covered;
      }
    }
    found.texels += covered;
  }
  return found;
}

void emit(Highlight found, uint index)
{
  if (found.weight <= 0.0) {
    // Counted, but by rounding not found again.
    found = Highlight(vec3(0.0), 1.0, 0.5 * view_buf.film.xy, 1.0 / view_buf.lens.x, 1.0);
  }
  vec2 clip = found.place / found.weight / view_buf.film.xy * 2.0 - 1.0;
  float depth = found.weight / found.inverse_depth;
  vec2 scale = vec2(view_buf.projection[0][0], view_buf.projection[1][1]);
  vec2 xy;
  if (view_buf.lens.y > 0.5) {
    xy = (clip - view_buf.projection[3].xy) / scale;
  }
  else {
    xy = (clip + view_buf.projection[2].xy) / scale * depth;
  }
  // Its true place, not where it appears from the view's place on the lens.
  xy += lens_view.xy * (view_buf.lens.x - depth) / view_buf.lens.x;
  float area = 1.0 / float(subpixels * subpixels);
  ivec2 place = list_texel(index);
  if (place.y >= imageSize(a_img).y) {
    return;
  }
  imageStore(a_img, place, vec4(xy, depth, sqrt(found.texels * area)));
  imageStore(b_img, place, vec4(found.energy * area, lens_view.z));
}

uint place_of(uint index)
{
  ivec2 texel = list_texel(index);
  return texelFetch(starts_tx, texel, 0).x + texelFetch(totals_tx, list_texel(uint(texel.y)), 0).x;
}
#endif

void main()
{
  uint tile = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
  ivec2 lane = ivec2(gl_LocalInvocationID.xy);
  if (tile >= uint(tiles)) {
    return;
  }
  ivec2 pixel = ivec2(texelFetch(listed_tx, list_texel(tile), 0).xy) * TILE + lane;
  uint index = tile * uint(TILE * TILE) + uint(lane.y * TILE + lane.x);
  bool sharp;
#ifdef EMIT
  uint start = place_of(index);
  uint count = place_of(index + 1u) - start;
  float from = -1e30;
  for (uint k = 0u; k < count; k++) {
    float to = 1e30;
    if (count > 1u) {
      from = coc_range(pixel, from, sharp).x;
      to = (k + 1u < count) ? from + COC_TOLERANCE : 1e30;
    }
    emit(gather(pixel, from, to), uint(first) + start + k);
    from = to;
  }
#else
  vec2 range = coc_range(pixel, -1e30, sharp);
  uint count = (range.y < range.x) ? 0u : 1u;
  bool ignored;
  while (range.y >= range.x + COC_TOLERANCE && count < MOST) {
    range = coc_range(pixel, range.x + COC_TOLERANCE, ignored);
    count++;
  }
  imageStore(starts_img, list_texel(index), uvec4(count));
  if (sharp) {
    imageAtomicAdd(sharp_img, ivec2(0), 1u);
  }
#endif
}
