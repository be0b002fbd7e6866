// One over the summed weights of the samples of each tile of TILE pixels: one number a channel, or with
// several CORNERS along each side of a tile the sums there, between which they are linear.
#ifndef TILE_SCALE_LIB_GLSL
#define TILE_SCALE_LIB_GLSL

vec4 tile_scale(sampler2D scales_tx, ivec2 texel)
{
#if CORNERS > 1
  vec2 at = (vec2(texel % TILE) + 0.5) * float(CORNERS - 1) / float(TILE);
  ivec2 cell = min(ivec2(at), CORNERS - 2);
  vec2 part = at - vec2(cell);
  ivec2 first = texel / TILE * CORNERS + cell;
  vec4 low = mix(texelFetch(scales_tx, first, 0), texelFetch(scales_tx, first + ivec2(1, 0), 0), part.x);
  vec4 high = mix(texelFetch(scales_tx, first + ivec2(0, 1), 0),
                  texelFetch(scales_tx, first + ivec2(1, 1), 0),
                  part.x);
  return 1.0 / mix(low, high, part.y);
#else
  return texelFetch(scales_tx, texel / TILE, 0);
#endif
}

#endif
