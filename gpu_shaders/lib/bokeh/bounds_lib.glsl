// Bounds of the depth in any rectangle of cells, from a stack of N-buffers (see
// bokeh_culling_bounds_comp).
#ifndef BOUNDS_LIB_GLSL
#define BOUNDS_LIB_GLSL

vec3 bounds_join(vec3 a, vec3 b)
{
  return vec3(min(a.x, b.x), max(a.yz, b.yz));
}

// Bounds over the cells from `low` to `high`, both inside the stack; of a long rectangle those of a
// wider one, at most a square.
vec3 bounds_of(sampler2DArray bounds_tx, ivec2 low, ivec2 high)
{
  ivec2 extent = high - low + 1;
  int level = min(findMSB(max(extent.x, extent.y)), textureSize(bounds_tx, 0).z - 1);
  ivec2 last = max(high - (1 << level) + 1, low);
  return bounds_join(bounds_join(texelFetch(bounds_tx, ivec3(low, level), 0).xyz,
                                 texelFetch(bounds_tx, ivec3(last.x, low.y, level), 0).xyz),
                     bounds_join(texelFetch(bounds_tx, ivec3(low.x, last.y, level), 0).xyz,
                                 texelFetch(bounds_tx, ivec3(last, level), 0).xyz));
}

#endif
