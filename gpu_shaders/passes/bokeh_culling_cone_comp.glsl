// Which clusters of triangles, or instances of a group, meet the cone from a source to the lens.
// Counts them for each undecided source; with FILL, writes the pairs where prefix sums place them.
// Inputs: sources_tx; boxes_tx, parts_tx, shapes_tx (see engine/occluders.py); instances_tx;
// visibility_buf; count; culls (x: 0: every source
// keeps its mask; y: 1: sources that the layers leave free are tested, too); corners_tx; ivec4 extent (GROUP: first and last row of a group's instances, z: segment of
// keys; else x: number of parts, z: segment); FILL: states_tx, keys_tx, totals_tx, window (places: first and
// number).
// GROUP: box (lower and upper corner of the mesh).
// Outputs: keys_img (pairs of a source), counts_img; states_img (whether anything meets the cone);
// FILL: pairs_img: source, row of the instance table, cluster.
// Source: methods 10 (J20 section 4.3.3).
#include "lib/instance_lib.glsl"
#include "lib/source_lib.glsl"

// Directions in which the opening is bounded: a polygon 8 % wider than a disc at its corners.
#define SIDES 8
#define PLANES 10
#define LEVELS 8
#define BRANCHES 8

#define CORNERS 8

// What holds the rays from the source to the opening: planes, on whose positive sides they are, and
// the corners of a frustum, for a box whose sides part it from them.
struct Bundle {
  vec4 planes[PLANES];
  vec3 corners[CORNERS];
  vec3 low;
  vec3 high;
};

// `farthest`: depth beyond which nothing counts, m.
Bundle source_bundle(Source source, float farthest)
{
  Bundle bundle;
  Cone cone = source.cone;
  // A mask is blurred when it is read: what lies 1.5 texels beyond the rim counts, also aslant.
  float side = visibility_buf.tiles.y * exp2(float(source_class(source.coc, visibility_buf)));
  vec2 opening = visibility_buf.opening.xy * (1.0 + 4.3 / side);
  for (int i = 0; i < SIDES; i++) {
    float angle = 6.2831853 * float(i) / float(SIDES);
    vec2 n = vec2(cos(angle), sin(angle));
    float reach = length(n * opening) * cone.rate;
    bundle.planes[i] = vec4(-n, reach - dot(n, cone.b), reach * cone.depth + dot(n, cone.a));
  }
  bundle.planes[SIDES] = vec4(0.0, 0.0, -1.0, -visibility_buf.opening.z);
  bundle.planes[SIDES + 1] = vec4(0.0, 0.0, 1.0, farthest);
  for (int i = 0; i < CORNERS; i++) {
    float z = (i & 4) == 0 ? visibility_buf.opening.z : farthest;
    vec2 corner = vec2((i & 1) == 0 ? -1.0 : 1.0, (i & 2) == 0 ? -1.0 : 1.0);
    vec2 lens = corner * opening * ((cone.depth - z) * cone.rate);
    bundle.corners[i] = vec3(cone.a + cone.b * z + lens, -z);
  }
  return bundle;
}

// The bundle in a space from which `matrix` leads to its own.
Bundle transform_bundle(Bundle bundle, mat4 matrix)
{
  mat3 back = inverse(mat3(matrix));
  bundle.low = vec3(1e30);
  bundle.high = vec3(-1e30);
  for (int i = 0; i < PLANES; i++) {
    bundle.planes[i] = bundle.planes[i] * matrix;
  }
  for (int i = 0; i < CORNERS; i++) {
    bundle.corners[i] = back * (bundle.corners[i] - matrix[3].xyz);
    bundle.low = min(bundle.low, bundle.corners[i]);
    bundle.high = max(bundle.high, bundle.corners[i]);
  }
  vec3 slack = 1e-5 * max(abs(bundle.low), abs(bundle.high));
  bundle.low -= slack;
  bundle.high += slack;
  return bundle;
}

bool meets_box(Bundle bundle, vec3 low, vec3 high)
{
  if (any(lessThan(high, bundle.low)) || any(greaterThan(low, bundle.high))) {
    return false;
  }
  vec3 center = 0.5 * (low + high), half_size = 0.5 * (high - low);
  for (int i = 0; i < PLANES; i++) {
    vec3 n = bundle.planes[i].xyz;
    float reach = dot(abs(n), half_size);
    float distance = dot(n, center) + bundle.planes[i].w;
    // A little more than exact, for rounding.
    if (distance + reach * 1.0001 + 1e-6 * abs(bundle.planes[i].w) < 0.0) {
      return false;
    }
  }
  return true;
}

#ifndef GROUP
bool meets(Bundle bundle, int box)
{
  return meets_box(bundle,
                   texelFetch(boxes_tx, list_texel(2 * box), 0).xyz,
                   texelFetch(boxes_tx, list_texel(2 * box + 1), 0).xyz);
}

// Whether any triangle of a cluster may meet the bundle: no plane of the bundle parts them, and not
// the triangle's own.
bool meets_cluster(Bundle bundle, int cluster)
{
  ivec2 place = ivec2((cluster % CLUSTERS_PER_ROW) * CLUSTER_CORNERS, cluster / CLUSTERS_PER_ROW);
  for (int i = 0; i < CLUSTER_CORNERS; i += 3) {
    vec3 a = texelFetch(corners_tx, place + ivec2(i, 0), 0).xyz;
    vec3 b = texelFetch(corners_tx, place + ivec2(i + 1, 0), 0).xyz;
    vec3 c = texelFetch(corners_tx, place + ivec2(i + 2, 0), 0).xyz;
    bool parted = any(lessThan(max(a, max(b, c)), bundle.low)) ||
                  any(greaterThan(min(a, min(b, c)), bundle.high));
    for (int k = 0; k < PLANES && !parted; k++) {
      vec3 n = bundle.planes[k].xyz;
      float slack = bundle.planes[k].w + 1e-6 * abs(bundle.planes[k].w);
      parted = max(dot(n, a), max(dot(n, b), dot(n, c))) + slack < 0.0;
    }
    if (parted) {
      continue;
    }
    vec3 n = cross(b - a, c - a);
    float low = 1e30, high = -1e30;
    for (int k = 0; k < CORNERS; k++) {
      float distance = dot(n, bundle.corners[k] - a);
      low = min(low, distance);
      high = max(high, distance);
    }
    if (low <= 0.0 && high >= 0.0 && n != vec3(0.0)) {
      return true;
    }
  }
  return false;
}

// A tree of boxes: `number` leaves from box `first` on, then what is round eight of them each.
struct Tree {
  int first[LEVELS];
  int number[LEVELS];
  int top;
};

Tree tree_of(int first, int number)
{
  Tree tree;
  tree.top = 0;
  tree.first[0] = first;
  tree.number[0] = number;
  while (number > BRANCHES && tree.top < LEVELS - 1) {
    first += number;
    number = (number + BRANCHES - 1) / BRANCHES;
    tree.top++;
    tree.first[tree.top] = first;
    tree.number[tree.top] = number;
  }
  return tree;
}

// Goes on from a box to the next leaf that meets the bundle; returns false at the end. `place`:
// level and number of the next box to look at.
bool next_leaf(Tree tree, Bundle bundle, inout ivec2 place, out int leaf)
{
  while (true) {
    int level = place.x, index = place.y;
    if (level == tree.top && index >= tree.number[level]) {
      return false;
    }
    bool met = index < tree.number[level] && meets(bundle, tree.first[level] + index);
    if (met && level > 0) {
      place = ivec2(level - 1, index * BRANCHES);
      continue;
    }
    place.y++;
    while (place.x < tree.top && place.y % BRANCHES == 0) {
      place = ivec2(place.x + 1, place.y / BRANCHES);
    }
    if (met) {
      leaf = index;
      return true;
    }
  }
  return false;
}

// Level of detail at which a part's triangles are about as large as a texel of the source's mask.
int level_of(Source source, vec4 part, int tree_box)
{
  vec3 low = texelFetch(boxes_tx, list_texel(2 * tree_box), 0).xyz;
  vec3 high = texelFetch(boxes_tx, list_texel(2 * tree_box + 1), 0).xyz;
  vec4 axis = vec4(0.0, 0.0, -1.0, 0.0) * visibility_buf.view;
  float farthest = dot(axis.xyz, 0.5 * (low + high)) + dot(abs(axis.xyz), 0.5 * (high - low)) +
                   axis.w;
  float side = visibility_buf.tiles.y * exp2(float(source_class(source.coc, visibility_buf)));
  float width = 2.0 * min(visibility_buf.opening.x, visibility_buf.opening.y);
  float texel = width * (source.cone.depth - farthest) * source.cone.rate / side;
  if (texel <= 0.0) {
    return 0;
  }
  return clamp(int(floor(log2(texel * texel / max(part.w, 1e-30)))), 0, int(part.z) - 1);
}
#endif

#ifndef FILL
// Whether anything so near that it reaches into the frame from outside the raster meets the cone.
bool meets_edge(Source source)
{
  float margin = min(visibility_buf.frame.x, visibility_buf.frame.y);
  float farthest = source.coc < margin ? min(source.hides, visibility_buf.tiles.w) : source.hides;
  Bundle bundle = transform_bundle(source_bundle(source, farthest), visibility_buf.view);
#ifdef GROUP
  for (int row = extent.x; row <= extent.y; row++) {
    Bundle own = transform_bundle(bundle, instance_world(instances_tx, row));
    if (meets_box(own, box_low.xyz, box_high.xyz)) {
      return true;
    }
  }
#else
  Tree parts = tree_of(0, extent.x);
  ivec2 at = ivec2(parts.top, 0);
  int number;
  while (next_leaf(parts, bundle, at, number)) {
    vec4 part = texelFetch(parts_tx, list_texel(2 * number), 0);
    vec4 shape = texelFetch(shapes_tx, list_texel(int(part.y)), 0);
    Bundle own = transform_bundle(bundle, instance_world(instances_tx, int(part.x)));
    Tree clusters = tree_of(int(shape.x), int(shape.y));
    ivec2 within = ivec2(clusters.top, 0);
    int cluster;
    while (next_leaf(clusters, own, within, cluster)) {
      if (meets_cluster(own, int(shape.z) + cluster)) {
        return true;
      }
    }
  }
#endif
  return false;
}
#endif

#ifdef FILL
void write_pair(inout uint place, int source, int row, int cluster)
{
  uint within = place - uint(window.x);
  if (within < uint(window.y)) {
    imageStore(pairs_img, list_texel(int(within)), vec4(source, row, cluster, 0.0));
  }
  place++;
}
#endif

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  ivec2 texel = list_texel(index);
  ivec2 key = texel + ivec2(0, extent.z);
#ifdef FILL
  if (index >= count || texelFetch(states_tx, texel, 0).w != STATE_OPEN) {
    return;
  }
  uint place = texelFetch(keys_tx, key, 0).x + texelFetch(totals_tx, list_texel(key.y), 0).x;
#else
  float state = index < count ? imageLoad(states_img, texel).w : 0.0;
  bool free = state == STATE_VISIBLE || state == STATE_EDGE;
  if (state != STATE_OPEN && state != STATE_FREE && !free) {
    imageStore(keys_img, key, uvec4(0u));
    return;
  }
#endif
  Source source = source_of(texelFetch(sources_tx, texel, 0), visibility_buf);
#ifndef FILL
  if (free && culls.y == 0 && (state == STATE_VISIBLE || !meets_edge(source))) {
    imageStore(keys_img, key, uvec4(0u));
    return;
  }
#endif
  Bundle bundle = transform_bundle(source_bundle(source, source.hides), visibility_buf.view);
  uint found = 0u;
#ifdef GROUP
  for (int row = extent.x; row <= extent.y; row++) {
    Bundle own = transform_bundle(bundle, instance_world(instances_tx, row));
    if (meets_box(own, box_low.xyz, box_high.xyz)) {
      found++;
#ifdef FILL
      write_pair(place, index, row, 0);
#endif
    }
  }
#else
  Tree parts = tree_of(0, extent.x);
  ivec2 at = ivec2(parts.top, 0);
  int number;
  while (next_leaf(parts, bundle, at, number)) {
    vec4 part = texelFetch(parts_tx, list_texel(2 * number), 0);
    int row = int(part.x);
    vec4 shape = texelFetch(
        shapes_tx, list_texel(int(part.y) + level_of(source, part, number)), 0);
    Bundle own = transform_bundle(bundle, instance_world(instances_tx, row));
    Tree clusters = tree_of(int(shape.x), int(shape.y));
    ivec2 within = ivec2(clusters.top, 0);
    int cluster;
    while (next_leaf(clusters, own, within, cluster)) {
      if (!meets_cluster(own, int(shape.z) + cluster)) {
        continue;
      }
      found++;
#ifdef FILL
      write_pair(place, index, row, int(shape.z) + cluster);
#endif
    }
  }
#endif
#ifndef FILL
  imageStore(keys_img, key, uvec4(found));
  if (found > 0u) {
    imageAtomicAdd(counts_img, ivec2(extent.w, 0), found);
  }
  // Free until something meets the cone.
  vec4 record = imageLoad(states_img, texel);
  if (found > 0u || culls.x == 0) {
    record.w = STATE_OPEN;
  }
  else if (state == STATE_OPEN && extent.w == COUNT_PAIRS) {
    record.w = STATE_FREE;
  }
  imageStore(states_img, texel, record);
#endif
}
