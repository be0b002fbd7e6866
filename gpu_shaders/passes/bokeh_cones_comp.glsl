// Which clusters of triangles meet the cone from a source to the lens. Counts them for each
// undecided source and lists as many pairs as there is room for, in any order. FILL writes pairs
// where prefix sums place them. EDGES only finds whether anything outside the raster of the layers
// meets the cones of those that nothing inside it lies before.
// Inputs: sources_tx; part_boxes_tx, parts_tx, shapes_tx, boxes_tx, corners_tx (see
// engine/occluders.py); instances_tx; visibility_buf; count; parts (boxes of their tree). Without EDGES:
// segment (first row of keys); culls (0: sources that are decided are tested, too); window (places that are
// listed: first and number). FILL: states_tx, keys_tx, totals_tx.
// Outputs: pairs_img: source, row of the instance table, cluster; keys_img (pairs of a source),
// counts_img, states_img (see bokeh_culling_comp).
// Source: methods 10 (J20 section 4.3.3).
#include "lib/cones_lib.glsl"
#include "lib/instance_lib.glsl"

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

// A part of the scene as a source sees it.
struct Part {
  int row;      // of the instance table
  float area;   // of a triangle, m^2
  int cluster;  // first one
  ivec2 boxes;  // first and behind the last of its tree
  LensView view;  // from object space
};

// Level of detail at which a part's triangles are about as large as a texel of the source's mask.
// `record`: of the part; `low`, `high`: its box; `view`: from world space.
int level_of(Source source, LensView view, vec4 record, vec3 low, vec3 high)
{
  float w = dot(view.w.xyz, 0.5 * (low + high)) + view.w.w -
            dot(abs(view.w.xyz), 0.5 * (high - low));
  float side = visibility_buf.tiles.y * exp2(float(source_class(source.coc, visibility_buf)));
  float texel = 2.0 * min(visibility_buf.opening.x, visibility_buf.opening.y) * w / side;
  if (texel <= 0.0) {
    return 0;
  }
  return clamp(int(floor(log2(texel * texel / max(record.w, 1e-30)))), 0, int(record.z) - 1);
}

Part part_of(Source source, LensView view, int number, vec3 low, vec3 high)
{
  vec4 record = texelFetch(parts_tx, list_texel(PART_TEXELS * number), 0);
  vec4 far = texelFetch(parts_tx, list_texel(PART_TEXELS * number + 1), 0);
  int level = level_of(source, view, record, low, high);
  vec4 shape = texelFetch(shapes_tx, list_texel(int(record.y) + level), 0);
  Part part;
  part.row = int(record.x);
  part.area = record.w;
  part.cluster = int(shape.z);
  part.boxes = ivec2(int(shape.x), int(shape.x + shape.y));
  part.view = lens_view_in(view, instance_world(instances_tx, part.row), far.xyz);
  return part;
}

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  ivec2 texel = list_texel(index);
#ifndef EDGES
  ivec2 key = texel + ivec2(0, segment);
#endif
#ifdef FILL
  if (index >= count) {
    return;
  }
  vec4 record = texelFetch(states_tx, texel, 0);
  uint place = texelFetch(keys_tx, key, 0).x + texelFetch(totals_tx, list_texel(key.y), 0).x;
  bool tested = state_is_open(record.w) || culls == 0;
#elif defined(EDGES)
  vec4 record = index < count ? imageLoad(states_img, texel) : vec4(0.0);
  bool tested = record.w == STATE_EDGE;
#else
  vec4 record = index < count ? imageLoad(states_img, texel) : vec4(0.0);
  bool tested = index < count && (state_is_open(record.w) || culls == 0);
  if (!tested) {
    imageStore(keys_img, key, uvec4(0u));
  }
#endif
  if (!tested) {
    return;
  }
  vec4 a = texelFetch(sources_tx, texel, 0);
  Source source = source_of(a, visibility_buf);
#ifdef EDGES
  LensView view = lens_view_of(source, edge_depth(source, visibility_buf), visibility_buf);
#else
  LensView view = lens_view_of(source, source.hides, visibility_buf);
  Met met = nothing_met();
#endif
  // Parts' boxes have a margin for rounding.
  view = lens_view_in(view, visibility_buf.view, vec3(0.0));
  int at = 0;
  vec4 low, high;
  while (next_leaf(part_boxes_tx, view, parts, at, low, high)) {
    Part part = part_of(source, view, int(high.w), low.xyz, high.xyz);
    int within = part.boxes.x;
    while (next_leaf(boxes_tx, part.view, part.boxes.y, within, low, high)) {
      int cluster = part.cluster + int(high.w);
      if (!meets_cluster(part.view, cluster)) {
        continue;
      }
#ifdef EDGES
      record.w = STATE_OPEN;
      imageStore(states_img, texel, record);
      return;
#else
#ifdef FILL
      uint at_place = place - uint(window.x) + met.found;
      met.found++;
#else
      uint at_place = imageAtomicAdd(counts_img, ivec2(COUNT_PAIRS, 0), 1u);
      float area = part.area * float(CLUSTER_CORNERS / 3);
      meet(met, part.view, source, a.w, area, low.xyz, high.xyz, visibility_buf);
#endif
      if (at_place < uint(window.y)) {
        vec4 pair = vec4(index, part.row, cluster, 0.0);
        imageStore(pairs_img, list_texel(int(at_place)), pair);
      }
#endif
    }
  }
#if !defined(FILL) && !defined(EDGES)
  imageStore(keys_img, key, uvec4(met.found));
  imageStore(states_img, texel, record_after(record, met, source, true, visibility_buf));
#endif
}
