// One lens sample's picture, blurred over the part of the lens that it stands for: rays from places
// near the sample's are cast through its own colour and depth. Each ray stands for a cell of the lens,
// and takes the mean of the colours that come to the pixel through it.
// Inputs: sample_tx, depth_tx (the sample); bounds_tx (depths that can reach a pixel); offsets_tx
// (row: sample; column: place on the lens relative to the sample's, m); means_tx, ranges_tx (pyramid
// of the sample, `top` levels); sample_index, count; spread (largest offset, m); cell (side of a
// cell of the lens, m); sweep; weight.
// CHROMATIC: as in surface_vert, and gain (of the sweep, by 1 / focus distance), tint (weights of the
// channels).
// Outputs: the weighted sum of the sample and its subsamples.
// Source: methods 6 (JKL13 section 6, algorithm 3).
#include "lib/nbuffer_lib.glsl"
#include "lib/sweep_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"

// The sweep where the pixel's place in the field puts the focus.
vec4 focused_sweep;
#else
#define focused_sweep sweep
#endif

// A hit is a texel whose surface comes to lie within so many texels of the pixel.
#define TOLERANCE 1.0
// Surfaces move alike across a cell if they do within so many texels.
#define MOVES_ALIKE 1.0

// From where to where a way, from 0 to 1, lies in the picture or within a texel of it.
vec2 part_inside(vec2 start, vec2 way, vec2 size)
{
  vec2 part = vec2(0.0, 1.0);
  for (int axis = 0; axis < 2; axis++) {
    if (abs(way[axis]) > 1.0) {
      float a = (-1.0 - start[axis]) / way[axis], b = (size[axis] + 1.0 - start[axis]) / way[axis];
      part = vec2(max(part.x, min(a, b)), min(part.y, max(a, b)));
    }
  }
  return clamp(part, 0.0, 1.0);
}

// Side of the square of texels over which a bilinear look-up spreads as far as a ray's cell does: in
// a level of squares of side w its variance is w^2 / 4, that of a cell c^2 / 12. Wider by a half,
// since the cells are no squares side by side.
#define WIDTH_OF_CELL 0.85

// The mean of the colours round a texel that a cell of the lens brings to one pixel: over as many
// texels as its surface moves across the cell, but only while what lies there moves alike.
vec4 cell_color(ivec2 texel, ivec2 size)
{
  float depth = texelFetch(depth_tx, texel, 0).x;
  vec2 span = abs(sweep_px(vec2(cell), focused_sweep, depth));
  float width = WIDTH_OF_CELL * min(span.x, span.y);
  int level = min(int(floor(log2(max(width, 1.0)) + 0.5)), top);
  vec2 by_depth = abs(focused_sweep.zw);
  float alike = MOVES_ALIKE / max(cell * max(by_depth.x, by_depth.y), 1e-30);
  for (; level > 0; level--) {
    ivec2 last = ((size + (1 << level) - 1) >> level) - 1;
    vec2 place = (vec2(texel) + 0.5) / float(1 << level) - 0.5;
    ivec2 low = clamp(ivec2(floor(place)), ivec2(0), last);
    ivec2 high = min(low + 1, last);
    ivec3 a = ivec3(low, level - 1), d = ivec3(high, level - 1);
    ivec3 b = ivec3(high.x, a.yz), c = ivec3(low.x, d.yz);
    vec2 range = extremes(
        extremes(texelFetch(ranges_tx, a, 0).xy, texelFetch(ranges_tx, b, 0).xy),
        extremes(texelFetch(ranges_tx, c, 0).xy, texelFetch(ranges_tx, d, 0).xy));
    if (range.y - range.x <= alike) {
      vec2 part = clamp(place - vec2(low), 0.0, 1.0);
      return mix(mix(texelFetch(means_tx, a, 0), texelFetch(means_tx, b, 0), part.x),
                 mix(texelFetch(means_tx, c, 0), texelFetch(means_tx, d, 0), part.x), part.y);
    }
  }
  return texelFetch(sample_tx, texel, 0);
}

vec4 cast_ray(ivec2 pixel, ivec2 size, vec2 move, vec2 bounds)
{
  vec2 near = sweep_px(move, focused_sweep, bounds.x);
  vec2 far = sweep_px(move, focused_sweep, bounds.y);
  vec2 way = near - far;
  vec2 center = vec2(pixel) + 0.5;
  vec2 inside = part_inside(center - near, way, vec2(size));
  vec2 start = center - near + way * inside.x;
  way *= max(inside.y - inside.x, 0.0);
  int steps = int(ceil(max(abs(way.x), abs(way.y))));
  ivec2 hit = pixel, behind = pixel;
  float closest = TOLERANCE, farthest = -1.0;
  bool found = false;
  for (int k = 0; k <= steps; k++) {
    vec2 place = start + way * (float(k) / float(max(steps, 1)));
    ivec2 texel = clamp(ivec2(floor(place)), ivec2(0), size - 1);
    float depth = texelFetch(depth_tx, texel, 0).x;
    vec2 miss = abs(vec2(texel) + 0.5 + sweep_px(move, focused_sweep, depth) - center);
    float distance = max(miss.x, miss.y);
    if (distance <= closest) {
      // The nearest surface that is hit, where it is hit best.
      closest = distance;
      hit = texel;
      found = true;
    }
    else if (found) {
      break;
    }
    if (depth > farthest) {
      farthest = depth;
      behind = texel;
    }
  }
  // Nothing that the sample sees came to lie here, so the ray looks past an edge at what the sample
  // does not see: that continues what lies farthest along the way, the background if it is there.
  return cell_color(found ? hit : behind, size);
}

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(sample_tx, 0);
  vec4 primary = texelFetch(sample_tx, pixel, 0);
  vec2 bounds = texelFetch(bounds_tx, pixel, 0).xy;
#ifdef CHROMATIC
  // The field changes so slowly that a surface has the focus of where its light arrives.
  vec2 place = gl_FragCoord.xy * chromatic_buf.raster.xy + chromatic_buf.raster.zw;
  float axial = field_strengths(field_tx, place, chromatic_buf).x;
  focused_sweep = sweep + gain * chromatic_focus(dispersion.x, axial, chromatic_buf);
#endif
  vec2 reach = max(abs(sweep_px(spread, focused_sweep, bounds.x)),
                   abs(sweep_px(spread, focused_sweep, bounds.y)));
  vec4 total = primary * float(count + 1);
  // What moves by less than half a texel stays in it.
  if (max(reach.x, reach.y) > 0.5) {
    total = cell_color(pixel, size);
    for (int i = 0; i < count; i++) {
      vec2 move = texelFetch(offsets_tx, ivec2(i, sample_index), 0).xy;
      total += cast_ray(pixel, size, move, bounds);
    }
  }
#ifdef CHROMATIC
  total *= tint;
#endif
  out_color = total * weight;
}
