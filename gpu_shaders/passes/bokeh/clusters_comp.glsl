// Merges the sources of each group, where their harm (see cluster_lib) is small enough. The steps, with
// prefix sums over `starts` after COUNT and after MARK:
// COUNT: a group's size, at its first source. FILL: the groups' members, group after group.
// MERGE: a group of several becomes one source, in place of its first, if that is harmless. MARK: 1 for
// each source that is left. WRITE: the sources that are left, in their old order.
// Inputs: number_tx (how many sources); COUNT: slots_tx, table_tx (see clusters_groups_comp), or
// leaders_img where WITH_LEADERS; MERGE: cluster_buf.
// Outputs: WRITE: a_out_img, b_out_img, number_img.
// Source: methods 9 (J20 section 4.2.2).

ivec2 list_texel(int index)
{
  return ivec2(index % SOURCE_COLUMNS, index / SOURCE_COLUMNS);
}

#ifdef PLACES
// Prefix sum of a texel.
uint place_of(ivec2 texel)
{
  return texelFetch(starts_tx, texel, 0).x + texelFetch(totals_tx, list_texel(texel.y), 0).x;
}
#endif

#ifdef COUNT
void handle(int index, int number)
{
  ivec2 texel = list_texel(index);
#ifdef WITH_LEADERS
  uint leader = imageLoad(leaders_img, texel).x;
#else
  uint slot = texelFetch(slots_tx, texel, 0).x;
  uint leader = texelFetch(table_tx, list_texel(int(slot)), 0).x - 1u;
  imageStore(leaders_img, texel, uvec4(leader));
#endif
  imageAtomicAdd(sizes_img, list_texel(int(leader)), 1u);
  imageAtomicAdd(starts_img, list_texel(int(leader)), 1u);
}
#endif

#ifdef FILL
void handle(int index, int number)
{
  ivec2 leader = list_texel(int(texelFetch(leaders_tx, list_texel(index), 0).x));
  uint place = place_of(leader) + imageAtomicAdd(cursors_img, leader, 1u);
  imageStore(members_img, list_texel(int(place)), uvec4(uint(index)));
}
#endif

#ifdef MERGE
#include "lib/bokeh/cluster_lib.glsl"
#include "lib/sum_lib.glsl"

struct Bounds {
  vec3 low;
  vec3 high;
  vec3 energy;   // of the strongest member
  float extent;
};

int member(int start, int k)
{
  return int(texelFetch(members_tx, list_texel(start + k), 0).x);
}

float largest(vec3 color)
{
  return max(color.r, max(color.g, color.b));
}

Bounds bounds_of(int start, int size)
{
  Bounds found = Bounds(vec3(1e30), vec3(-1e30), vec3(0.0), 0.0);
  for (int k = 0; k < size; k++) {
    ivec2 texel = list_texel(member(start, k));
    vec4 a = imageLoad(a_img, texel);
    vec4 b = imageLoad(b_img, texel);
    vec3 place = cluster_place(a.xyz, cluster_buf.lens);
    found.low = min(found.low, place);
    found.high = max(found.high, place);
    found.energy = max(found.energy, b.rgb);
    found.extent = max(found.extent, a.w);
  }
  return found;
}

void handle(int index, int number)
{
  ivec2 texel = list_texel(index);
  uint merged = 0u;
  int size = int(texelFetch(sizes_tx, texel, 0).x);
  if (size > 1) {
    int start = int(place_of(texel));
    Bounds bounds = bounds_of(start, size);
    vec3 span = max(bounds.high - bounds.low, vec3(1e-30));
    float strongest = power_above(largest(bounds.energy));
    float extent_scale = max(bounds.extent * bounds.extent, 1e-30);
    // Sums of whole numbers do not depend on the order of the members.
    Sum red = NO_SUM, green = NO_SUM, blue = NO_SUM, weight = NO_SUM;
    Sum x = NO_SUM, y = NO_SUM, z = NO_SUM, xx = NO_SUM, yy = NO_SUM, zz = NO_SUM, extent = NO_SUM;
    for (int k = 0; k < size; k++) {
      ivec2 other = list_texel(member(start, k));
      vec4 a = imageLoad(a_img, other);
      vec4 b = imageLoad(b_img, other);
      vec3 energy = b.rgb / strongest;
      float w = largest(energy);
      vec3 place = clamp((cluster_place(a.xyz, cluster_buf.lens) - bounds.low) / span, 0.0, 1.0);
      sum_add(red, energy.r);
      sum_add(green, energy.g);
      sum_add(blue, energy.b);
      sum_add(weight, w);
      sum_add(x, w * place.x);
      sum_add(y, w * place.y);
      sum_add(z, w * place.z);
      sum_add(xx, w * place.x * place.x);
      sum_add(yy, w * place.y * place.y);
      sum_add(zz, w * place.z * place.z);
      sum_add(extent, w * (a.w * a.w / extent_scale));
    }
    float total = max(sum_value(weight), 1e-30);
    vec3 mean = vec3(sum_value(x), sum_value(y), sum_value(z)) / total;
    vec3 spread = vec3(sum_value(xx), sum_value(yy), sum_value(zz)) / total - mean * mean;
    float pixel = cluster_buf.cell.y;
    // Discs of different sizes blur the rim of the merged disc as shifted ones do.
    vec3 scale = span * vec3(1.0 / pixel, 1.0 / pixel, coc_rate(cluster_buf.lens));
    vec3 variance = max(spread, 0.0) * scale * scale;
    float own = sum_value(extent) / total * extent_scale;
    // A square's variance along a side is a twelfth of its area.
    float side = sqrt(own + 6.0 * (variance.x + variance.y) + 12.0 * variance.z);
    vec3 place = bounds.low + mean * span;
    vec3 source = cluster_source(place, cluster_buf.lens);
    float coc = abs(coc_radius_px(source.z, cluster_buf.lens));
    vec3 energy = vec3(sum_value(red), sum_value(green), sum_value(blue)) * strongest;
    if (cluster_harmless(side, coc, largest(energy), cluster_buf)) {
      merged = 1u;
      imageStore(a_img, texel, vec4(source, side));
      imageStore(b_img, texel, vec4(energy, imageLoad(b_img, texel).w));
    }
  }
  imageStore(merged_img, texel, uvec4(merged));
}
#endif

#ifdef MARK
void handle(int index, int number)
{
  ivec2 texel = list_texel(index);
  int leader = int(texelFetch(leaders_tx, texel, 0).x);
  bool goes = index != leader && texelFetch(merged_tx, list_texel(leader), 0).x != 0u;
  imageStore(marks_img, texel, uvec4(goes ? 0u : 1u));
  imageStore(starts_img, texel, uvec4(goes ? 0u : 1u));
}
#endif

#ifdef WRITE
void handle(int index, int number)
{
  ivec2 texel = list_texel(index);
  uint place = place_of(texel);
  uint own = texelFetch(marks_tx, texel, 0).x;
  if (own != 0u) {
    imageStore(a_out_img, list_texel(int(place)), texelFetch(a_tx, texel, 0));
    imageStore(b_out_img, list_texel(int(place)), texelFetch(b_tx, texel, 0));
  }
  if (index == number - 1) {
    imageStore(number_img, ivec2(0), uvec4(place + own));
  }
}
#endif

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  int number = int(texelFetch(number_tx, ivec2(0), 0).x);
  if (index < number) {
    handle(index, number);
  }
}
