// Which highlights are similar enough to be merged into one cluster (methods 9); the same as
// benchmarks/reference/clusters.py.
//
// Cells are cubes of world space, so that they stay where they are while the camera moves. The side
// at level l is 2^l times a share of the circle of confusion that a highlight has in object space,
// rounded down to a power of two: neighbours at about the same depth agree about it. Cells may be
// longer along the camera's axis.
#ifndef CLUSTER_LIB_GLSL
#define CLUSTER_LIB_GLSL
#include "lib/lens_lib.glsl"

// Axes of the cells. Turned, because scenes are full of surfaces along the world's axes: where one
// lay on the border of two layers of cells, rounding would decide its cell.
#define CELL_AXES \
  (mat3(vec3(-29.0, 26.0, -2.0), vec3(-14.0, -13.0, 34.0), vec3(22.0, 26.0, 19.0)) / 39.0)
// Offset of the cells' origin, in sides.
#define CELL_SHIFT vec3(0.37, 0.61, 0.17)
// More than the number of logarithms of sides.
#define SCALES 1024
// A blur of this many pixels is as visible in a larger disc as in one of this radius, px.
#define HARM_RADIUS 8.0

// The coordinates in which sources are averaged: place in the picture, and the function of the depth
// in which the circle of confusion is linear.
vec3 cluster_place(vec3 source, vec4 lens)
{
  return (lens.y > 0.5) ? source : vec3(source.xy, 1.0) / source.z;
}

// The source at a place; the way back is the same.
vec3 cluster_source(vec3 place, vec4 lens)
{
  return cluster_place(place, lens);
}

// How the circle of confusion changes with the third coordinate, px.
float coc_rate(vec4 lens)
{
  return (lens.y > 0.5) ? lens.z / lens.x : lens.z;
}

// Side of a pixel at a depth, m.
float cluster_pixel(float depth, ClusterParams params)
{
  return (params.lens.y > 0.5) ? params.cell.y : params.cell.y * depth;
}

// Logarithm of the side of a source's cell.
int cluster_scale(float depth, float level, ClusterParams params)
{
  float radius = abs(coc_radius_px(depth, params.lens)) * cluster_pixel(depth, params);
  return int(floor(log2(max(params.cell.x * radius, 1e-30)) + level));
}

// The cell of a source: which one along its axes, and the logarithm of its side with the region of
// the lens. `source`: x, y, depth, m, and region; `shift`: of the cells, in sides.
ivec4 cluster_cell(vec4 source, float level, float shift, ClusterParams params)
{
  int scale = cluster_scale(source.z, level, params);
  vec3 world = (params.world * vec4(source.xy, -source.z, 1.0)).xyz;
  vec3 cell = floor(CELL_AXES * world * ldexp(1.0, -scale) + (CELL_SHIFT + shift));
  // Far from the origin, cells are no finer than the numbers.
  return ivec4(ivec3(clamp(cell, -1e9, 1e9)), scale + SCALES * int(source.w));
}

uint cluster_hash(ivec4 cell)
{
  uvec4 c = uvec4(cell);
  uint hash = c.x * 0x9e3779b1u ^ c.y * 0x85ebca77u ^ c.z * 0xc2b2ae3du ^ c.w * 0x27d4eb2fu;
  hash ^= hash >> 15u;
  hash *= 0x2c1b3c6du;
  hash ^= hash >> 12u;
  hash *= 0x297a2d39u;
  return hash ^ (hash >> 15u);
}

// Whether sources may be merged: the merged disc is blurred over `extent`, px; `coc`: its radius, px;
// `energy`: of its brightest channel.
bool cluster_harmless(float extent, float coc, float energy, ClusterParams params)
{
  float peak = energy / (3.14159265 * coc * coc);
  float harm = peak * extent * extent / (HARM_RADIUS * coc);
  return extent <= params.limits.x * coc && harm <= params.limits.y;
}

#endif
