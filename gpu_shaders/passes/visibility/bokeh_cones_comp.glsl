// Finds the clusters of triangles that meet the cone from a source to the lens. Counts them for each
// undecided source and lists as many pairs as there is room for, in any order. FILL writes pairs
// where prefix sums place them. EDGES only finds whether a surface outside the layers' raster meets the
// cone of a source that no surface inside it is in front of.
// Inputs: sources_tx; part_boxes_tx, parts_tx, shapes_tx, boxes_tx, corners_tx (see
// engine/drawing/occluders.py); instances_tx; visibility_buf; count; parts (boxes of their tree). Without EDGES:
// segment (first row of keys); culls (0: sources that are decided are tested, too); window (places that are
// listed: first and number). FILL: states_tx, keys_tx, totals_tx.
// Outputs: pairs_img: source, row of the instance table, cluster; keys_img (pairs of a source),
// counts_img, states_img (see bokeh_culling_comp).
// Source: methods 10 (J20 section 4.3.3).
#include "lib/surface/instance_lib.glsl"
#include "passes/visibility/bokeh_cones_source.glsl"

// Side of a triangle of a level of detail, in texels of a mask. A level is made to lie much closer to
// the surface than its triangles are large: on a street of 400000 triangles in one mesh, this differs
// from full detail by 1e-4 in SSIM, and draws a tenth of the triangles.
#define TRIANGLE_TEXELS 5.0

// Whether any triangle of a cluster may meet the cone.
bool meets_cluster(LensView view, int cluster)
{
  ivec2 place = ivec2((cluster % CLUSTERS_PER_ROW) * CLUSTER_CORNERS, cluster / CLUSTERS_PER_ROW);
  for (int i = 0; i < CLUSTER_CORNERS; i += 3) {
    vec3 a = texelFetch(corners_tx, place + ivec2(i, 0), 0).xyz;
    vec3 b = texelFetch(corners_tx, place + ivec2(i + 1, 0), 0).xyz;
    vec3 c = texelFetch(corners_tx, place + ivec2(i + 2, 0), 0).xyz;
    if (meets_triangle(view, a, b, c)) {
      return true;
    }
  }
  return false;
}

// Goes on from a box of a tree to the next leaf that meets the cone, and behind it; returns false at
// the end. Boxes lie before those inside them; `low.w`: how many boxes on what is not inside begins;
// `high.w`: number of a leaf, otherwise negative. `box`: the next one to look at.
bool next_leaf(sampler2D boxes, LensView view, int end, inout int box, out vec4 low, out vec4 high)
{
  while (box < end) {
    ivec2 texel = list_texel(2 * box);
    low = texelFetch(boxes, texel, 0);
    high = texelFetch(boxes, texel + ivec2(1, 0), 0);
    bool met = meets_box(view, low.xyz, high.xyz);
    box += met ? 1 : int(low.w);
    if (met && high.w >= 0.0) {
      return true;
    }
  }
  return false;
}

// A part of the scene (one surface of one instance), seen from a source.
struct Part {
  int row;        // of the instance table
  int shape;      // of level of detail 0
  int levels;
  float area;     // of a triangle at level 0, m^2
  LensView view;  // from object space
};

Part part_of(LensView view, int number)
{
  vec4 record = texelFetch(parts_tx, list_texel(PART_TEXELS * number), 0);
  vec4 far = texelFetch(parts_tx, list_texel(PART_TEXELS * number + 1), 0);
  mat4 world = instance_world(instances_tx, int(record.x));
  LensView own = lens_view_in(view, world, far.xyz);
  return Part(int(record.x), int(record.y), int(record.z), record.w, own);
}

// The w from which on a part is drawn at a level of detail: where its triangles are about as large as a
// few texels of the source's mask; coarser towards the lens. Their area doubles from level to level. A
// cluster that lies in the ranges of two levels is drawn at both, so that no gap is left.
float least_w(Source source, Part part, int level)
{
  if (level == 0) {
    return -1e30;
  }
  if (level == part.levels) {
    return 1e30;
  }
  float side = visibility_buf.tiles.y * exp2(float(source_class(source.coc, visibility_buf)));
  float width = 2.0 * min(visibility_buf.opening.x, visibility_buf.opening.y);
  return sqrt(part.area * exp2(float(level))) * side / (width * TRIANGLE_TEXELS);
}

void main()
{
  int index = int(gl_GlobalInvocationID.x);
#ifdef EDGES
  ConeSource from = source_of_thread(index, 0);
#else
  ConeSource from = source_of_thread(index, segment);
  Met met = nothing_met();
#endif
  if (!from.tested) {
    return;
  }
  // Parts' boxes have a margin for rounding.
  LensView view = lens_view_in(from.view, visibility_buf.view, vec3(0.0));
  int at = 0;
  vec4 low, high;
  while (next_leaf(part_boxes_tx, view, parts, at, low, high)) {
    Part part = part_of(view, int(high.w));
    for (int level = 0; level < part.levels; level++) {
      LensView own = part.view;
      own.range.x = max(own.range.x, least_w(from.source, part, level));
      own.range.y = min(own.range.y, least_w(from.source, part, level + 1));
      if (own.range.x > own.range.y) {
        continue;
      }
      vec4 shape = texelFetch(shapes_tx, list_texel(part.shape + level), 0);
      int within = int(shape.x);
      int end = within + int(shape.y);
      while (next_leaf(boxes_tx, own, end, within, low, high)) {
        int cluster = int(shape.z + high.w);
        if (!meets_cluster(own, cluster)) {
          continue;
        }
#ifdef EDGES
        vec4 record = from.record;
        record.w = STATE_OPEN;
        imageStore(states_img, from.texel, record);
        return;
#else
#ifdef FILL
        uint at_place = from.place - uint(window.x) + met.found;
        met.found++;
#else
        uint at_place = imageAtomicAdd(counts_img, ivec2(COUNT_PAIRS, 0), 1u);
        float area = part.area * exp2(float(level)) * float(CLUSTER_CORNERS / 3);
        meet(met, own, from.source, from.side, area, low.xyz, high.xyz, visibility_buf);
#endif
        if (at_place < uint(window.y)) {
          vec4 pair = vec4(index, part.row, cluster, 0.0);
          imageStore(pairs_img, list_texel(int(at_place)), pair);
        }
#endif
      }
    }
  }
#if !defined(FILL) && !defined(EDGES)
  imageStore(keys_img, from.key, uvec4(met.found));
  vec4 record = record_after(from.record, met, from.source, true, visibility_buf);
  imageStore(states_img, from.texel, record);
#endif
}
