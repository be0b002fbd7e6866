// Look-ups in one of several tiles that stand side by side in a picture; as in Cycles each goes on beyond
// its edges as if it were alone.
#ifndef TILES_LIB_GLSL
#define TILES_LIB_GLSL
#include "lib/surface/texture_lib.glsl"

// `uv`: place in the UV plane; `slot`: the tile's number in the picture, -1 for none; `grid`: tiles
// across and up; `share`: the tile's size, as a share of the grid's cells; `taps`: 1, 2 or 4 texels a side are read.
vec4 image_tiled(sampler2D tx, vec2 uv, int slot, ivec2 grid, vec2 share, int taps, int extension)
{
  if (slot < 0) {
    return vec4(1.0, 0.0, 1.0, 1.0);
  }
  ivec2 cell = textureSize(tx, 0) / grid;
  ivec2 origin = cell * ivec2(slot % grid.x, slot / grid.x);
  ivec2 size = max(ivec2(vec2(cell) * share + 0.5), ivec2(1));
  vec2 place = fract(uv) * vec2(size) - ((taps == 1) ? 0.0 : 0.5);
  vec2 corner = floor(place), t = place - corner;
  vec4 x = (taps == 4) ? cubic_weights(t.x) : vec4(0.0, 1.0 - t.x, t.x, 0.0);
  vec4 y = (taps == 4) ? cubic_weights(t.y) : vec4(0.0, 1.0 - t.y, t.y, 0.0);
  if (taps == 1) {
    x = y = vec4(0.0, 1.0, 0.0, 0.0);
  }
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 16; i++) {
    ivec2 step = ivec2(i & 3, i >> 2);
    float weight = x[step.x] * y[step.y];
    if (weight != 0.0) {
      ivec2 texel = ivec2(corner) + step - 1;
      texel.x = extend_texel(texel.x, size.x, extension);
      texel.y = extend_texel(texel.y, size.y, extension);
      sum += weight * texelFetch(tx, origin + texel, 0);
    }
  }
  return sum;
}

#endif
