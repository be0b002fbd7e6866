// Highlights of one peeled layer. First they are counted for each pixel; then, once it is known
// where each row's list begins (highlights_rows), EMIT writes them.
// The sub-pixels of a pixel are one highlight, or two where they lie so far apart in depth that
// their circles of confusion differ.
// Inputs: color_tx (light above the threshold), depth_tx (window depth); view_buf (of the peeled
// raster), highlight_buf; layer; size (of the part of the raster that counts, px); with EMIT rows_img
// and lens_view (xy: place on the lens that it was seen from, m; z: region of the lens that it stands
// for). WORLD: the world at infinity, no depth.
// Outputs: counts_img: highlights of a pixel, and those too sharp to be splatted times 256; EMIT
// reads the highlights of a pixel and how many come before it in its row, times 4, and fills a_img
// (x, y and depth in camera space, m; side of the square it stands for, px) and b_img (energy:
// radiance times pixels; region of the lens).
// Source: methods 9 (J20 section 4.1).
#include "lib/depth_lib.glsl"
#include "lib/highlight_lib.glsl"
#include "lib/lens_lib.glsl"

// Circles of confusion that differ by more are not averaged, px.
#define COC_TOLERANCE 1.0

struct Highlight {
  vec3 energy;
  float weight;
  vec2 place;           // weighted, in texels
  float inverse_depth;  // weighted
  float texels;
};

float texel_depth(ivec2 texel)
{
#ifdef WORLD
  return highlight_buf.world.x;
#else
  float window_depth = texelFetch(depth_tx, texel, 0).x;
  return depth_from_window(window_depth, view_buf.projection, view_buf.lens);
#endif
}

float share_of(float coc)
{
#ifdef WORLD
  return highlight_buf.world.z;
#else
  return highlight_share(coc, highlight_buf.split.y);
#endif
}

float largest(vec3 color)
{
  return max(color.r, max(color.g, color.b));
}

// Circles of confusion of a pixel's highlights, least and largest; the largest is the less where
// there are none. Bright texels that are too sharp are counted.
vec2 coc_range(ivec2 pixel, out bool sharp)
{
  vec2 range = vec2(1e30, -1e30);
  sharp = false;
  for (int y = 0; y < SUBPIXELS; y++) {
    for (int x = 0; x < SUBPIXELS; x++) {
      ivec2 texel = pixel * SUBPIXELS + ivec2(x, y);
      if (largest(texelFetch(color_tx, texel, 0).rgb) <= 0.0) {
        continue;
      }
      float coc = coc_radius_px(texel_depth(texel), view_buf.lens);
      if (share_of(coc) > 0.0) {
        range = vec2(min(range.x, coc), max(range.y, coc));
      }
      else {
        sharp = true;
      }
    }
  }
  return range;
}

uint highlights_of(vec2 range)
{
  if (range.y < range.x) {
    return 0u;
  }
  return (range.y - range.x > COC_TOLERANCE) ? 2u : 1u;
}

#ifdef EMIT
// The texels of a pixel whose circles of confusion lie in [from, to).
Highlight gather(ivec2 pixel, float from, float to)
{
  Highlight found = Highlight(vec3(0.0), 0.0, vec2(0.0), 0.0, 0.0);
  for (int y = 0; y < SUBPIXELS; y++) {
    for (int x = 0; x < SUBPIXELS; x++) {
      ivec2 texel = pixel * SUBPIXELS + ivec2(x, y);
      vec3 excess = texelFetch(color_tx, texel, 0).rgb;
      float peak = largest(excess);
      if (peak <= 0.0) {
        continue;
      }
      float depth = texel_depth(texel);
      float coc = coc_radius_px(depth, view_buf.lens);
      float share = share_of(coc);
      if (share <= 0.0 || coc < from || coc >= to) {
        continue;
      }
      float weight = peak * share;
      found.energy += excess * share;
      found.weight += weight;
      found.place += (vec2(texel) + 0.5) * weight;
      found.inverse_depth += weight / depth;
      found.texels += 1.0;
    }
  }
  return found;
}

void emit(Highlight found, uint index)
{
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
  // Where it is, not where it appears from that place.
  xy += lens_view.xy * (view_buf.lens.x - depth) / view_buf.lens.x;
  float area = 1.0 / float(SUBPIXELS * SUBPIXELS);
  ivec2 place = ivec2(index % SOURCE_COLUMNS, index / SOURCE_COLUMNS);
  if (place.y >= imageSize(a_img).y) {
    return;
  }
  imageStore(a_img, place, vec4(xy, depth, sqrt(found.texels * area)));
  imageStore(b_img, place, vec4(found.energy * area, lens_view.z));
}
#endif

void main()
{
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) {
    return;
  }
#ifdef EMIT
  uint before = imageLoad(counts_img, ivec3(pixel, layer)).x;
  uint count = before & 3u;
  if (count == 0u) {
    return;
  }
  uint index = imageLoad(rows_img, ivec2(pixel.y, layer)).x + (before >> 2u);
  bool sharp;
  vec2 range = coc_range(pixel, sharp);
  float middle = (count == 1u) ? 1e30 : 0.5 * (range.x + range.y);
  emit(gather(pixel, -1e30, middle), index);
  if (count == 2u) {
    emit(gather(pixel, middle, 1e30), index + 1u);
  }
#else
  bool sharp;
  uint count = highlights_of(coc_range(pixel, sharp));
  imageStore(counts_img, ivec3(pixel, layer), uvec4(count + (sharp ? 256u : 0u)));
#endif
}
