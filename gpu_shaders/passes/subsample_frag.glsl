// Subsample blur: one lens sample's picture, blurred over the part of the lens that it stands for. Rays
// from subsamples, places on the lens near the sample's, are cast through its own colour and depth.
// Each ray stands for a cell of the lens, and takes the mean colour that reaches the pixel through it.
// Inputs: sample_tx, depth_tx (the sample); means_tx, ranges_tx (its pyramid); subsample_buf; offsets_tx
// (row: sample; column: place on the lens relative to the sample's, m, and from a pixel's centre to the
// place that is looked at, texels of the sample); sample_index, count; jitter (the place that is looked at
// near the picture's edges); apart (largest distance of any place along x and y, texels); weight.
// CHROMATIC: as in surface_vert, and tint (weights of the channels).
// REAL_LENS: as in surface_vert; turns_tx (how the lens' displacements change with the place on it:
// columns of a matrix in texels a metre, in the left half, and per unit of the depth buffer, in the right),
// light_tx (what the lens lets through at the places of the picture).
// PIXEL_SETS: places on the lens differ from pixel to pixel, in squares of PIXEL_SETS x PIXEL_SETS pixels:
// there are so many rows of offsets_tx a sample, from the lower left one on, of count + 1 places in all.
// Outputs: the weighted sum of the sample and its subsamples. PIXEL_SETS: the sums of what is seen blurred in
// front of the focus, and of all else; the share of the first, the least blur of the others, texels, and
// the weight that both are without.
// Source: methods 6 (JKL13 section 6, algorithm 3).
#include "lib/extremes_lib.glsl"
#include "lib/bokeh/sweep_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"

// The sweep for the focus at the pixel's place in the field.
vec4 focused_sweep;
#else
#define focused_sweep subsample_buf.sweep
#endif

#ifdef REAL_LENS
#include "lib/light_table_lib.glsl"
#include "lib/real_lens_lib.glsl"

// What the lens adds to the sweep at the pixel's place in the field.
mat2 own_turn, own_turn_by_depth;
#endif

// Movement for a place on the lens at a distance of `move`, texels.
vec2 moved_px(vec2 move, float depth)
{
  vec2 moved = sweep_px(move, focused_sweep, depth);
#ifdef REAL_LENS
  moved += own_turn * move + own_turn_by_depth * move * depth;
#endif
  return moved;
}

// Largest movement along x and y for all places as near as `spread` along either axis, texels.
vec2 reach_px(vec2 spread, float depth)
{
#ifdef REAL_LENS
  vec2 diagonal = focused_sweep.xy + focused_sweep.zw * depth;
  mat2 whole = own_turn + own_turn_by_depth * depth + mat2(diagonal.x, 0.0, 0.0, diagonal.y);
  return abs(whole[0]) * spread.x + abs(whole[1]) * spread.y;
#else
  return abs(sweep_px(spread, focused_sweep, depth));
#endif
}

// Change of the movement with the depth buffer's value, texels.
vec2 parted_px(vec2 move)
{
#ifdef REAL_LENS
  return abs(move * focused_sweep.zw + own_turn_by_depth * move);
#else
  return abs(move * focused_sweep.zw);
#endif
}

// Neighbouring texels are one surface if their movements for the ray differ by no more, in texels.
#define SURFACE_STRETCH 1.0
// Surfaces move alike if their movements across a cell of the lens differ by no more, in texels.
#define MOVES_ALIKE 1.0
// Least length of a ray's path along an axis, in texels; a shorter one does not move along it.
#define LEAST_WAY 1e-6
// Iterations that narrow the depths that can reach a pixel (depths_in_reach).
#define APPROACHES 3

// Side of the pyramid's squares over that of a cell's movement, so that a bilinear look-up blurs as the
// cell does: in a level of squares of side w its variance is w^2 / 4, that of a cell c^2 / 12. Wider by
// a half, since the cells do not tile the lens as squares.
#define WIDTH_OF_CELL 0.85

// Level of the pyramid with squares as wide as a surface of this depth moves across a cell of the lens.
int level_of_cell(float depth)
{
  vec2 span = reach_px(vec2(subsample_buf.cell.x), depth);
  float width = WIDTH_OF_CELL * min(span.x, span.y);
  return int(floor(log2(max(width, 1.0)) + 0.5));
}

// Mean colour round a texel that a cell of the lens brings to one pixel: over as many texels as the
// surface moves across the cell, but only where all surfaces there move alike, and none of them less than
// the means are wide: its light would be in the means beside it, and all of it in its own texels.
vec4 cell_color(ivec2 texel, ivec2 size)
{
  float depth = texelFetch(depth_tx, texel, 0).x;
  int level = min(level_of_cell(depth), int(subsample_buf.cell.y));
#ifdef REAL_LENS
  vec2 by_depth = abs(vec2(own_turn_by_depth[0].x, own_turn_by_depth[1].y) + focused_sweep.zw);
#else
  vec2 by_depth = abs(focused_sweep.zw);
#endif
  float alike = MOVES_ALIKE / max(subsample_buf.cell.x * max(by_depth.x, by_depth.y), 1e-30);
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
    bool is_alike = range.y - range.x <= alike;
    if (is_alike && min(level_of_cell(range.x), level_of_cell(range.y)) >= level) {
      vec2 part = clamp(place - vec2(low), 0.0, 1.0);
      return mix(mix(texelFetch(means_tx, a, 0), texelFetch(means_tx, b, 0), part.x),
                 mix(texelFetch(means_tx, c, 0), texelFetch(means_tx, d, 0), part.x), part.y);
    }
  }
  return texelFetch(sample_tx, texel, 0);
}

// Depth range of the sample over the pyramid's squares that a rectangle of texels touches.
vec2 seen_depths(ivec2 a, ivec2 b)
{
  ivec2 low = min(a, b), high = max(a, b);
  int level = max(findMSB(max(high.x - low.x, high.y - low.y)), 0) + 1;
  if (level > int(subsample_buf.cell.z)) {
    return subsample_buf.bounds.zw;
  }
  ivec3 c = ivec3(low >> level, level - 1), d = ivec3(high >> level, level - 1);
  return extremes(extremes(texelFetch(ranges_tx, c, 0).xy, texelFetch(ranges_tx, d, 0).xy),
                  extremes(texelFetch(ranges_tx, ivec3(d.x, c.yz), 0).xy,
                           texelFetch(ranges_tx, ivec3(c.x, d.yz), 0).xy));
}

// Depth range over a square of the pyramid, or of a texel (level 0).
vec2 square_depths(ivec2 square, int level)
{
  return (level == 0) ? vec2(texelFetch(depth_tx, square, 0).x) :
                        texelFetch(ranges_tx, ivec3(square, level - 1), 0).xy;
}

// The texel that a ray sees. Each texel is a square that moves with its surface; the ray ends at the
// nearest that comes to cover `center`, the place that is looked at. So a surface of one depth covers
// as many pixels as it has texels, wherever it moves to.
// The colour of a texel is that at its centre plus the sample's jitter, so squares are centred there, and
// lie elsewhere in each sample. Places that are looked at are spread so much less than the pixel filter
// that with a square's own extent they are spread as the filter: edges are as wide in any blur, and
// movements below a texel are blurred by their mean, not by none or by one texel.
// As the depth goes from the least in reach to the largest, the texel that would come to the pixel runs
// along a straight path. A texel is hit if its depth lies between those at which the path enters and
// leaves it. Whole squares of the pyramid in front of or behind the path's depths are skipped.
ivec2 seen_texel(vec2 center, ivec2 size, vec2 move, vec2 in_reach)
{
  vec2 start = center - moved_px(move, in_reach.x);
  vec2 along = center - moved_px(move, in_reach.y) - start;
  vec2 part = vec2(0.0, 1.0);
  // Outside, the picture's outermost texels are repeated: a path beyond an edge runs along it.
  for (int axis = 0; axis < 2; axis++) {
    float a = start[axis], b = a + along[axis], edge = float(size[axis]);
    if (max(a, b) < 0.0 || min(a, b) > edge) {
      start[axis] = (a < 0.0) ? 0.5 : edge - 0.5;
      along[axis] = 0.0;
    }
    else if (min(a, b) < 0.0 || max(a, b) > edge) {
      vec2 meets = (vec2(0.0, edge) - a) / along[axis];
      part = vec2(max(part.x, min(meets.x, meets.y)), min(part.y, max(meets.x, meets.y)));
    }
  }
  part.y = max(part.x, part.y);
  ivec2 texel = clamp(ivec2(floor(start + along * part.x)), ivec2(0), size - 1);
  ivec2 last = clamp(ivec2(floor(start + along * part.y)), ivec2(0), size - 1);
  ivec2 stride = ivec2(sign(along));
  bvec2 moves = greaterThan(abs(along), vec2(LEAST_WAY));
  vec2 pace = vec2(stride) / max(abs(along), LEAST_WAY);
  float extent = max(in_reach.y - in_reach.x, 1e-20);
  // Where the path entered the texel, as a share of its length; of the first texel, where it would have.
  vec2 enters = (vec2(texel) + max(-vec2(stride), 0.0) - start) * pace;
  enters = mix(vec2(-1e30), enters, moves);
  float entered = max(enters.x, enters.y);
  // The last texel whose surface the ray was in front of, and whether that is the previous texel.
  ivec2 ahead = texel;
  bool was_ahead = false, begun = false;
  int level = 0;
  while (true) {
    ivec2 square = texel >> level, low = square << level;
    ivec2 edge = low + max(stride, 0) * ((1 << level) - 1);
    vec2 leaves = (vec2(edge) + max(vec2(stride), 0.0) - start) * pace;
    leaves = mix(vec2(1e30), leaves, moves);
    bvec2 goes_on = notEqual(last >> level, square);
    // Rounding may not lead past the last texel.
    int axis = (!goes_on.y || (goes_on.x && leaves.x <= leaves.y)) ? 0 : 1;
    float left = any(goes_on) ? leaves[axis] : min(leaves.x, leaves.y);
    vec2 seen = square_depths(square, level);
    bool in_front = seen.x > in_reach.x + extent * left;
    bool behind = seen.y < in_reach.x + extent * entered;
    if (level > 0 && !in_front && (!behind || was_ahead)) {
      level--;
      continue;
    }
    if (!in_front && !behind) {
      return texel;
    }
    // The texel through which the path leaves the square.
    ivec2 leaving = last;
    if (any(goes_on)) {
      ivec2 on_way = ivec2(floor(start + along * left));
      on_way = clamp(on_way, max(min(texel, last), low), min(max(texel, last), low + (1 << level) - 1));
      leaving[axis] = edge[axis];
      leaving[1 - axis] = on_way[1 - axis];
    }
    if (in_front) {
      ahead = leaving;
    }
    else if (level == 0 && (was_ahead || !begun)) {
      // The ray has crossed a slope between two texels, passed the edge of a nearer surface, or comes
      // from beyond the picture's edge.
      vec2 parted = parted_px(move);
      float gap = texelFetch(depth_tx, ahead, 0).x - seen.x;
      if (!begun || gap * max(parted.x, parted.y) <= SURFACE_STRETCH) {
        return ahead;
      }
    }
    if (!any(goes_on)) {
      break;
    }
    was_ahead = in_front;
    begun = true;
    texel = leaving;
    texel[axis] += stride[axis];
    entered = left;
    level = min(level + 1, int(subsample_buf.cell.z));
  }
  // The sample does not show what the ray sees: the surface that went behind an edge is continued.
  return ahead;
}

// Depth range of what can reach a pixel from the sample's part of the lens, and how far away that may
// lie, in texels: the depths of the whole picture bound the distance, the distance bounds the depths,
// and so on.
vec2 depths_in_reach(ivec2 pixel, ivec2 size, out int reach)
{
  vec2 spread = subsample_buf.bounds.xy;
  vec2 found = subsample_buf.bounds.zw;
  for (int i = 0; i <= APPROACHES; i++) {
    vec2 moved = max(reach_px(spread, found.x), reach_px(spread, found.y));
    // Up to the edge of its square, the pixel's own texel is seen.
    moved += apart + 0.5;
    reach = int(min(max(moved.x, moved.y), float(max(size.x, size.y))));
    if (reach == 0 || i == APPROACHES) {
      break;
    }
    vec2 seen = seen_depths(max(pixel - reach, ivec2(0)), min(pixel + reach, size - 1));
    if (seen == found) {
      break;
    }
    found = seen;
  }
  return found;
}

#ifdef PIXEL_SETS
// Radius of the circle of confusion from which on a surface in front of the focus is blurred, texels.
#define BLURRED 2.0
// Blur where nothing is seen but surfaces that are blurred in front of the focus.
#define UNSEEN 1e4

vec4 near_sum = vec4(0.0);
float near_count = 0.0, least_blur = UNSEEN;

// The colour of a texel that is seen, in the sum that it belongs to.
vec4 sorted_color(ivec2 texel, ivec2 size)
{
  float depth = texelFetch(depth_tx, texel, 0).x;
  vec2 blurs = reach_px(subsample_buf.bounds.xy, depth);
  float blur = min(blurs.x, blurs.y);
  vec4 color = cell_color(texel, size);
  // The movement changes its sign at the focus; the least depth is in front of it.
  float nearest = focused_sweep.y + focused_sweep.w * subsample_buf.bounds.z;
  float here = focused_sweep.y + focused_sweep.w * depth;
  bool in_front = nearest * focused_sweep.w < 0.0 && nearest * here > 0.0;
  if (in_front && blur >= BLURRED) {
    near_sum += color;
    near_count += 1.0;
    return vec4(0.0);
  }
  least_blur = min(least_blur, blur);
  return color;
}

int row_of_offsets(ivec2 pixel)
{
  ivec2 place = pixel % PIXEL_SETS;
  return (sample_index * PIXEL_SETS + place.y) * PIXEL_SETS + place.x;
}
#else
#define sorted_color cell_color
#define row_of_offsets(pixel) sample_index
#endif

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(sample_tx, 0);
#ifdef CHROMATIC
  // The field changes so slowly that a surface has the focus of where its light arrives.
  vec2 place = gl_FragCoord.xy * chromatic_buf.raster.xy + chromatic_buf.raster.zw;
  float axial = field_strengths(field_tx, place, chromatic_buf).x;
  focused_sweep = subsample_buf.sweep +
                  subsample_buf.gain * chromatic_focus(dispersion.x, axial, chromatic_buf);
#endif
#ifdef REAL_LENS
  vec2 shown = gl_FragCoord.xy * real_lens_buf.raster.xy + real_lens_buf.raster.zw;
  vec2 node = real_lens_node(shown, lens_slot, real_lens_buf);
  vec4 turn = textureLod(turns_tx, node, 0.0);
  vec4 by_depth = textureLod(turns_tx, node + vec2(0.5, 0.0), 0.0);
  own_turn = mat2(turn.xy, turn.zw);
  own_turn_by_depth = mat2(by_depth.xy, by_depth.zw);
#endif
  int reach;
  vec2 in_reach = depths_in_reach(pixel, size, reach);
  vec4 total;
  if (reach == 0) {
    total = texelFetch(sample_tx, pixel, 0) * float(count + 1);
#ifdef PIXEL_SETS
    least_blur = 0.0;
#endif
  }
  else {
#ifdef PIXEL_SETS
    total = vec4(0.0);
    int places = count + 1;
#else
    total = cell_color(pixel, size);
    int places = count;
#endif
    // What lies beyond the picture's edges cannot be looked at: there, the place in the pixel is the
    // sample's own, as far as it is not a matter of whole texels.
    vec2 to_edge = vec2(min(pixel, size - 1 - pixel)) + 0.5;
    bvec2 inside = greaterThan(to_edge, apart);
    for (int i = 0; i < places; i++) {
      vec4 subsample = texelFetch(offsets_tx, ivec2(i, row_of_offsets(pixel)), 0);
      vec2 center = vec2(pixel) + 0.5 + mix(jitter, subsample.zw, inside);
      total += sorted_color(seen_texel(center, size, subsample.xy, in_reach), size);
    }
  }
#ifdef CHROMATIC
  total *= tint;
#endif
  float light = weight;
#ifdef REAL_LENS
  vec4 table = vec4(real_lens_buf.light.xy, real_lens_buf.table.z, float(lens_slot));
  light *= light_at(light_tx, gl_FragCoord.xy / vec2(size), table).x;
#endif
#ifdef PIXEL_SETS
  out_color = total;
  out_near = near_sum;
  out_shares = vec4(near_count / float(count + 1), least_blur, light, 0.0);
#else
  out_color = total * light;
#endif
}
