// Voronoi cells with Blender's own numbers: a random point in each cell of a lattice.
// Worley, A cellular texture basis function, SIGGRAPH 1996; distances to edges and smooth cells:
// Quilez, Voronoi edges and Smooth Voronoi.
// Places are vec4 of which the first `dims` components count, as in the noise library.
#ifndef VORONOI_LIB_GLSL
#define VORONOI_LIB_GLSL
#include "lib/nodes/random_lib.glsl"

#define VORONOI_F1 0
#define VORONOI_F2 1
#define VORONOI_SMOOTH_F1 2
#define VORONOI_DISTANCE_TO_EDGE 3
#define VORONOI_N_SPHERE_RADIUS 4

#define VORONOI_EUCLIDEAN 0
#define VORONOI_MANHATTAN 1
#define VORONOI_CHEBYCHEV 2
#define VORONOI_MINKOWSKI 3

struct VoronoiLook {
  int dims;
  int feature;
  int metric;
  bool normalizes;
  float scale;
  float detail;
  float roughness;
  float lacunarity;
  float smoothness;
  float exponent;
  float randomness;
};

struct VoronoiCell {
  float distance;
  vec3 color;
  vec4 place;
};

// Random numbers of whole ones: PCG in 2 to 4 dimensions. Jarzynski and Olano, Hash functions for GPU
// rendering, JCGT 9(3), 2020; with signed numbers, whose shifts keep the sign.
ivec2 pcg(ivec2 v)
{
  v = v * 1664525 + 1013904223;
  v.x += v.y * 1664525;
  v.y += v.x * 1664525;
  v ^= v >> 16;
  v.x += v.y * 1664525;
  v.y += v.x * 1664525;
  return v;
}

ivec3 pcg(ivec3 v)
{
  v = v * 1664525 + 1013904223;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v;
}

ivec4 pcg(ivec4 v)
{
  v = v * 1664525 + 1013904223;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

vec4 pcg_unit(ivec4 bits)
{
  return vec4(bits & 0x7fffffff) / 2147483647.0;
}

// The random point of a cell, from its corner.
vec4 cell_point(vec4 cell, int dims)
{
  ivec4 k = ivec4(cell);
  if (dims == 1) {
    return vec4(random_of(cell.x), 0.0, 0.0, 0.0);
  }
  if (dims == 2) {
    return pcg_unit(ivec4(pcg(k.xy), 0, 0));
  }
  return (dims == 3) ? pcg_unit(ivec4(pcg(k.xyz), 0)) : pcg_unit(pcg(k));
}

vec3 cell_color(vec4 cell, int dims)
{
  ivec4 k = ivec4(cell);
  if (dims == 1) {
    return random_color_of(cell, 1);
  }
  if (dims == 2) {
    return pcg_unit(ivec4(pcg(ivec3(k.xy, 0)), 0)).xyz;
  }
  return (dims == 3) ? pcg_unit(ivec4(pcg(k.xyz), 0)).xyz : pcg_unit(pcg(k)).xyz;
}

float voronoi_distance(vec4 d, VoronoiLook v)
{
  vec4 a = abs(d);
  if (v.metric == VORONOI_MANHATTAN) {
    return a.x + a.y + a.z + a.w;
  }
  if (v.metric == VORONOI_CHEBYCHEV) {
    return max(max(a.x, a.y), max(a.z, a.w));
  }
  if (v.metric == VORONOI_MINKOWSKI) {
    vec4 raised = pow(max(a, 1e-30), vec4(v.exponent));
    float sum = raised.x;
    sum += (v.dims > 1) ? raised.y : 0.0;
    sum += (v.dims > 2) ? raised.z : 0.0;
    sum += (v.dims > 3) ? raised.w : 0.0;
    return pow(sum, 1.0 / v.exponent);
  }
  return length(d);
}

// Neighbours of a cell are numbered; the number as an offset of -reach to reach in each direction.
int voronoi_neighbours(int reach, int dims)
{
  int side = 2 * reach + 1, count = side;
  for (int i = 1; i < dims; i++) {
    count *= side;
  }
  return count;
}

vec4 voronoi_neighbour(int number, int reach, int dims)
{
  int side = 2 * reach + 1;
  ivec4 steps = ivec4(number, number / side, number / (side * side), number / (side * side * side));
  vec4 offset = vec4(steps - (steps / side) * side - reach);
  return offset * vec4(1.0, dims > 1, dims > 2, dims > 3);
}

VoronoiCell voronoi_smooth(vec4 corner, vec4 local, VoronoiLook v)
{
  VoronoiCell cell = VoronoiCell(0.0, vec3(0.0), vec4(0.0));
  bool first = true;
  for (int i = 0; i < voronoi_neighbours(2, v.dims); i++) {
    vec4 offset = voronoi_neighbour(i, 2, v.dims);
    vec4 point = offset + cell_point(corner + offset, v.dims) * v.randomness;
    float d = voronoi_distance(point - local, v);
    float h = 1.0;
    if (!first) {
      float t = clamp(0.5 + 0.5 * (cell.distance - d) / v.smoothness, 0.0, 1.0);
      h = t * t * (3.0 - 2.0 * t);
    }
    first = false;
    float fix = v.smoothness * h * (1.0 - h);
    cell.distance = mix(cell.distance, d, h) - fix;
    fix /= 1.0 + 3.0 * v.smoothness;
    cell.color = mix(cell.color, cell_color(corner + offset, v.dims), h) - fix;
    cell.place = mix(cell.place, point, h) - fix;
  }
  cell.place += corner;
  return cell;
}

VoronoiCell voronoi_octave(vec4 p, VoronoiLook v)
{
  vec4 corner = floor(p), local = p - corner;
  if (v.feature == VORONOI_SMOOTH_F1 && v.smoothness > 0.0) {
    return voronoi_smooth(corner, local, v);
  }
  float nearest = 1e30, second = 1e30;
  vec4 point_1 = vec4(0.0), point_2 = vec4(0.0), offset_1 = vec4(0.0), offset_2 = vec4(0.0);
  for (int i = 0; i < voronoi_neighbours(1, v.dims); i++) {
    vec4 offset = voronoi_neighbour(i, 1, v.dims);
    vec4 point = offset + cell_point(corner + offset, v.dims) * v.randomness;
    float d = voronoi_distance(point - local, v);
    if (d < nearest) {
      second = nearest;
      point_2 = point_1;
      offset_2 = offset_1;
      nearest = d;
      point_1 = point;
      offset_1 = offset;
    }
    else if (d < second) {
      second = d;
      point_2 = point;
      offset_2 = offset;
    }
  }
  bool is_second = v.feature == VORONOI_F2;
  vec4 offset = is_second ? offset_2 : offset_1;
  return VoronoiCell(is_second ? second : nearest,
                     cell_color(corner + offset, v.dims),
                     (is_second ? point_2 : point_1) + corner);
}

VoronoiLook voronoi_bounded(VoronoiLook v)
{
  v.detail = clamp(v.detail, 0.0, 15.0);
  v.roughness = clamp(v.roughness, 0.0, 1.0);
  v.randomness = clamp(v.randomness, 0.0, 1.0);
  v.smoothness = clamp(0.5 * v.smoothness, 0.0, 0.5);
  return v;
}

// A sum of octaves; `p` is scaled already.
VoronoiCell voronoi_texture(vec4 p, VoronoiLook look)
{
  VoronoiLook v = voronoi_bounded(look);
  float amplitude = 1.0, largest = 0.0, frequency = 1.0;
  VoronoiCell sum = VoronoiCell(0.0, vec3(0.0), vec4(0.0));
  bool single = v.detail == 0.0 || v.roughness == 0.0;
  for (int i = 0; i <= int(ceil(v.detail)); i++) {
    VoronoiCell octave = voronoi_octave(p * frequency, v);
    if (single) {
      largest = 1.0;
      sum = octave;
      break;
    }
    // The last octave counts by the fraction of the detail.
    float share = (float(i) <= v.detail) ? 1.0 : fract(v.detail);
    largest += share * amplitude;
    sum.distance += share * octave.distance * amplitude;
    sum.color += share * octave.color * amplitude;
    sum.place = mix(sum.place, octave.place / frequency, share * amplitude);
    frequency *= v.lacunarity;
    amplitude *= v.roughness;
  }
  if (v.normalizes) {
    vec4 half_cell = vec4(1.0, v.dims > 1, v.dims > 2, v.dims > 3) * (0.5 + 0.5 * v.randomness);
    float farthest = voronoi_distance(half_cell, v) * ((v.feature == VORONOI_F2) ? 2.0 : 1.0);
    sum.distance /= largest * farthest;
    sum.color /= largest;
  }
  sum.place = (v.scale != 0.0) ? sum.place / v.scale : vec4(0.0);
  return sum;
}

float voronoi_edge_octave(vec4 p, VoronoiLook v)
{
  vec4 corner = floor(p), local = p - corner, nearest = vec4(0.0);
  float least = 1e30;
  for (int i = 0; i < voronoi_neighbours(1, v.dims); i++) {
    vec4 offset = voronoi_neighbour(i, 1, v.dims);
    vec4 away = offset + cell_point(corner + offset, v.dims) * v.randomness - local;
    float d = dot(away, away);
    if (d < least) {
      least = d;
      nearest = away;
    }
  }
  float edge = 1e30;
  for (int i = 0; i < voronoi_neighbours(1, v.dims); i++) {
    vec4 offset = voronoi_neighbour(i, 1, v.dims);
    vec4 away = offset + cell_point(corner + offset, v.dims) * v.randomness - local;
    vec4 across = away - nearest;
    // Not the nearest one itself.
    if (dot(across, across) > 0.0001) {
      edge = min(edge, dot(0.5 * (nearest + away), normalize(across)));
    }
  }
  return edge;
}

float voronoi_edge(vec4 p, VoronoiLook look)
{
  VoronoiLook v = voronoi_bounded(look);
  float amplitude = 1.0, frequency = 1.0, edge = 8.0;
  float farthest = 0.5 + 0.5 * v.randomness, largest = farthest;
  bool single = v.detail == 0.0 || v.roughness == 0.0;
  for (int i = 0; i <= int(ceil(v.detail)); i++) {
    float octave = voronoi_edge_octave(p * frequency, v);
    if (single) {
      edge = octave;
      break;
    }
    float share = (float(i) <= v.detail) ? 1.0 : fract(v.detail);
    largest = mix(largest, mix(largest, farthest / frequency, amplitude), share);
    float nearer = mix(edge, min(edge, octave / frequency), amplitude);
    edge = mix(edge, min(edge, nearer), share);
    frequency *= v.lacunarity;
    amplitude *= v.roughness;
  }
  return v.normalizes ? edge / largest : edge;
}

float voronoi_radius(vec4 p, VoronoiLook look)
{
  VoronoiLook v = voronoi_bounded(look);
  vec4 corner = floor(p), local = p - corner;
  vec4 nearest = vec4(0.0), nearest_offset = vec4(0.0);
  float least = 1e30;
  for (int i = 0; i < voronoi_neighbours(1, v.dims); i++) {
    vec4 offset = voronoi_neighbour(i, 1, v.dims);
    vec4 point = offset + cell_point(corner + offset, v.dims) * v.randomness;
    float d = distance(point, local);
    if (d < least) {
      least = d;
      nearest = point;
      nearest_offset = offset;
    }
  }
  float between = 1e30;
  for (int i = 0; i < voronoi_neighbours(1, v.dims); i++) {
    vec4 step = voronoi_neighbour(i, 1, v.dims);
    if (step == vec4(0.0)) {
      continue;
    }
    vec4 offset = step + nearest_offset;
    vec4 point = offset + cell_point(corner + offset, v.dims) * v.randomness;
    between = min(between, distance(point, nearest));
  }
  return 0.5 * between;
}

#endif
