// Groups of sources that are tried as one cluster: each source gets the number of its group's first.
// CELLS: the sources in one cell of world space. A hash table holds the first source of each cell, with
// linear probing.
// NEAREST: the nearest source of each, or itself where none is near.
// PAIRS: two sources that are nearest to each other.
// Inputs: a_tx, b_tx (see highlights_comp); number_tx (how many); cluster_buf; level; CELLS: shift of
// the cells in sides.
// Outputs: CELLS: table_img (first source + 1, 0 is empty), slots_img (place in it). NEAREST:
// nearest_img. PAIRS: leaders_img, from nearest_tx.
// Source: methods 9 (J20 section 4.2.2).
#include "lib/bokeh/cluster_lib.glsl"

ivec2 list_texel(int index)
{
  return ivec2(index % SOURCE_COLUMNS, index / SOURCE_COLUMNS);
}

#ifndef PAIRS
// x, y, depth, m, and region of the lens.
vec4 source_at(int index)
{
  ivec2 texel = list_texel(index);
  return vec4(texelFetch(a_tx, texel, 0).xyz, texelFetch(b_tx, texel, 0).w);
}
#endif

#ifdef CELLS
ivec4 cell_at(int index)
{
  return cluster_cell(source_at(index), level, shift, cluster_buf);
}

void group_source(int index)
{
  ivec4 cell = cell_at(index);
  uint slot = cluster_hash(cell) & uint(slots_mask);
  uint own = uint(index) + 1u;
  // There are twice as many slots as sources.
  for (uint tries = 0u; tries <= uint(slots_mask); tries++) {
    ivec2 texel = list_texel(int(slot));
    uint other = imageAtomicCompSwap(table_img, texel, 0u, own);
    if (other == 0u || cell_at(int(other) - 1) == cell) {
      imageAtomicMin(table_img, texel, own);
      imageStore(slots_img, list_texel(index), uvec4(slot));
      return;
    }
    slot = (slot + 1u) & uint(slots_mask);
  }
}
#endif

#ifdef NEAREST
void group_source(int index)
{
  int number = int(texelFetch(number_tx, ivec2(0), 0).x);
  vec4 own = source_at(index);
  float own_scale = exp2(float(cluster_scale(own.z, level, cluster_buf)));
  float least = 1e30;
  int nearest = index;
  for (int other = 0; other < number; other++) {
    vec4 place = source_at(other);
    float reach = min(own_scale, exp2(float(cluster_scale(place.z, level, cluster_buf))));
    float apart = distance(own.xyz, place.xyz);
    bool likely = other != index && place.w == own.w && apart < reach;
    if (likely && apart < least) {
      least = apart;
      nearest = other;
    }
  }
  imageStore(nearest_img, list_texel(index), uvec4(uint(nearest)));
}
#endif

#ifdef PAIRS
void group_source(int index)
{
  uint nearest = texelFetch(nearest_tx, list_texel(index), 0).x;
  bool mutual = texelFetch(nearest_tx, list_texel(int(nearest)), 0).x == uint(index);
  uint leader = mutual ? min(nearest, uint(index)) : uint(index);
  imageStore(leaders_img, list_texel(index), uvec4(leader));
}
#endif

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  if (uint(index) < texelFetch(number_tx, ivec2(0), 0).x) {
    group_source(index);
  }
}
