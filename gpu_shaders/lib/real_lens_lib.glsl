// A real lens (methods 1): what it adds to the thin lens' shear, from tables over field and vergence.
// A table has the powers 0 and 1 of the vergence in its left half, 2 and 3 in its right half, x and y
// each, with linear filtering over its nodes.
#ifndef REAL_LENS_LIB_GLSL
#define REAL_LENS_LIB_GLSL

// Place of a field in the tables of a sample's left half, 0 to 1.
vec2 real_lens_node(vec2 place, int slot, RealLensParams params)
{
  vec2 size = params.table.xy;
  vec2 node = clamp((place - params.grid.xy) * params.grid.zw, 0.0, 1.0) * (size - 1.0);
  node.y += float(slot) * size.y;
  return (node + 0.5) / vec2(2.0 * size.x, params.table.z * size.y);
}

// Displacement of a point, as tangents. `place` in the field, `vergence` 1 / depth, 1/m; `slot`: place
// of the lens sample in the tables. Points outside of the nodes move as those on their edge.
vec2 real_lens_move(sampler2D moves_tx, vec2 place, float vergence, int slot, RealLensParams params)
{
  vec2 at = real_lens_node(place, slot, params);
  vec4 low = textureLod(moves_tx, at, 0.0);
  vec4 high = textureLod(moves_tx, at + vec2(0.5, 0.0), 0.0);
  float v = min(vergence * params.vergence.x, 1.0);
  vec2 move = low.xy + v * (low.zw + v * (high.xy + v * high.zw));
  // Nearer points go on as the nearest of the tables.
  return move * max((vergence - params.vergence.y) * params.vergence.z, 1.0);
}

// Place of a field in a table of its own at the same nodes, 0 to 1.
vec2 real_lens_place(vec2 place, RealLensParams params)
{
  vec2 size = params.table.xy;
  return (clamp((place - params.grid.xy) * params.grid.zw, 0.0, 1.0) * (size - 1.0) + 0.5) / size;
}

// What the lens adds to the signed radius of a point's circle of confusion, px.
float real_lens_blur(sampler2D blur_tx, vec3 eye, RealLensParams params)
{
  float depth = max(-eye.z, 1e-6);
  vec4 blur = textureLod(blur_tx, real_lens_place(eye.xy / depth, params), 0.0);
  float v = min(params.vergence.x / depth, 1.0);
  float added = blur.x + v * (blur.y + v * (blur.z + v * blur.w));
  return added * max((1.0 / depth - params.vergence.y) * params.vergence.z, 1.0);
}

// How much larger the whole iris shows a small surface than a pinhole does.
float real_lens_area(sampler2D area_tx, vec3 eye, RealLensParams params)
{
  float depth = max(-eye.z, 1e-6);
  vec4 area = textureLod(area_tx, real_lens_place(eye.xy / depth, params), 0.0);
  float v = min(params.vergence.x / depth, 1.0);
  return area.x + v * (area.y + v * (area.z + v * area.w));
}

// What a point of camera space is moved by, m. At the camera's plane and behind it: as just before it.
vec2 real_lens_shift(sampler2D moves_tx, vec3 eye, int slot, RealLensParams params)
{
  float depth = max(-eye.z, 1e-6);
  return real_lens_move(moves_tx, eye.xy / depth, 1.0 / depth, slot, params) * depth;
}

#endif
