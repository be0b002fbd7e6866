// A ray of the lens in the raster of depth layers, for passes that include it.
// In the raster and its depth buffer's values the ray of a thin lens is a straight line; a real lens bends
// it: by a cubic of the vergence up to that of the nearest surface.
// Inputs: layered_buf; REAL_LENS: real_lens_buf, moves_tx.
// Source: methods 7 (LES09 section 4) and 1.
#ifndef LAYER_RAY_GLSL
#define LAYER_RAY_GLSL
#ifdef REAL_LENS
#include "lib/real_lens_lib.glsl"

// How often the point is looked for that the lens moves to the ray's pixel.
#define BEND_LOOKS 2
#endif

// The ray: its place in a layer's raster is start - along * depth, less the bend.
vec2 ray_start, ray_along;
#ifdef REAL_LENS
// Powers of the vergence in the unit of the nodes, texels of the layer.
vec2 bend[4];

float vergence_at(float depth)
{
  return layered_buf.vergence.x + layered_buf.vergence.y * depth;
}

float in_nodes(float vergence)
{
  return clamp(vergence / layered_buf.vergence.z, 0.0, 1.0);
}

// Nearer points go on as the nearest of the lens' tables do.
float beyond_tables(float vergence)
{
  return max((vergence - real_lens_buf.vergence.y) * real_lens_buf.vergence.z, 1.0);
}

vec2 bend_at(float depth)
{
  float vergence = vergence_at(depth), v = in_nodes(vergence);
  return (bend[0] + v * (bend[1] + v * (bend[2] + v * bend[3]))) * beyond_tables(vergence);
}
#endif

vec2 ray_place(float depth)
{
#ifdef REAL_LENS
  return ray_start - ray_along * depth - bend_at(depth);
#else
  return ray_start - ray_along * depth;
#endif
}

// Texels that the ray passes while its depth changes by one, where it has a depth.
float pace_at(float depth)
{
  vec2 along = ray_along;
#ifdef REAL_LENS
  float vergence = vergence_at(depth), v = in_nodes(vergence);
  if (beyond_tables(vergence) > 1.0) {
    along += (bend[0] + bend[1] + bend[2] + bend[3]) * real_lens_buf.vergence.z * layered_buf.vergence.y;
  }
  else if (v < 1.0) {
    vec2 slope = bend[1] + v * (2.0 * bend[2] + v * 3.0 * bend[3]);
    along += slope * (layered_buf.vergence.y / layered_buf.vergence.z);
  }
#endif
  return max(abs(along.x), abs(along.y));
}

// Rectangle that holds the ray between two depths.
void ray_bounds(vec2 between, out vec2 low, out vec2 high)
{
  vec2 a = ray_place(between.x), b = ray_place(between.y);
  low = min(a, b);
  high = max(a, b);
#ifdef REAL_LENS
  float near = vergence_at(between.x), far = vergence_at(between.y), end = layered_buf.vergence.z;
  if (near > end && far < end) {
    vec2 c = ray_place((end - layered_buf.vergence.x) / layered_buf.vergence.y);
    low = min(low, c);
    high = max(high, c);
  }
  // A cubic leaves its chord by no more than that.
  vec2 v = vec2(in_nodes(near), in_nodes(far));
  vec2 turn = max(abs(2.0 * bend[2] + 6.0 * v.x * bend[3]), abs(2.0 * bend[2] + 6.0 * v.y * bend[3]));
  turn *= 0.125 * (v.x - v.y) * (v.x - v.y);
  low -= turn;
  high += turn;
#endif
}

#ifdef REAL_LENS
// Which points the lens moves to a pixel, at four vergences: their field is that of a thin lens, less what
// the lens adds to it there. `place` of the pixel and `axis`, texels of the sample; `lens`: place on it, m;
// `moves`: the sweep; `scale`: the wavelength's; `slot`: place in the lens' tables.
void bend_ray(vec2 place, vec2 axis, vec2 lens, vec4 moves, float scale, int slot)
{
  mat4x2 bends;
  vec2 to_field = real_lens_buf.raster.xy;
  for (int i = 0; i < 4; i++) {
    float v = layered_buf.nodes[i] * layered_buf.vergence.z;
    float depth = (v - layered_buf.vergence.x) / layered_buf.vergence.y;
    vec2 thin = axis + (place - axis - lens * (moves.xy + moves.zw * depth)) / scale, at = thin;
    for (int j = 0; j < BEND_LOOKS; j++) {
      vec2 field_at = at * to_field + real_lens_buf.raster.zw;
      at = thin - real_lens_move(moves_tx, field_at, v, slot, real_lens_buf) / (to_field * scale);
    }
    bends[i] = (thin - at) * layered_buf.raster.xy;
  }
  mat4x2 powers = bends * transpose(layered_buf.powers);
  bend = vec2[4](powers[0], powers[1], powers[2], powers[3]);
}
#endif

#endif
