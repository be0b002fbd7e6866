// One level of the pyramids of all layers: mean colour, and least, largest and mean depth and coverage
// over squares twice as wide as in the level before.
// Inputs: colors_tx, depths_tx (the layers); level (from 1); alpha_covers (1: the colour's alpha is the
// coverage; 0: the share beside the depth); eyes (places on the lens that colours are seen from).
// Outputs: means_img (premultiplied colour); ranges_img (x, y: least and largest depth of what is
// covered, 2 and -1 if nothing is; z: mean depth of what is covered; w: coverage).
// Source: methods 7 (LES09 section 5); Decoret, N-buffers, EG 2005.
#include "lib/pyramid_atlas_lib.glsl"

ivec2 size, below, from;

// One of the four squares of the level before, and whether there is such a one.
bool part_of(ivec2 square, int i, out ivec2 texel)
{
  texel = 2 * square + ivec2(i & 1, i >> 1);
  return all(lessThan(texel, below));
}

vec4 mean_color(ivec2 square, int layer, int color_layer)
{
  vec4 color = vec4(0.0);
  float shares = 0.0;
  ivec2 texel;
  for (int i = 0; i < 4; i++) {
    if (!part_of(square, i, texel)) {
      continue;
    }
    shares += 1.0;
    if (level > 1) {
      color += imageLoad(means_img, ivec3(from + texel, color_layer));
    }
    else if (texelFetch(depths_tx, ivec3(texel, layer), 0).x <= 1.0) {
      // Those of filtered pictures are premultiplied.
      float share = (alpha_covers == 1) ? 1.0 : texelFetch(depths_tx, ivec3(texel, layer), 0).y;
      color += share * texelFetch(colors_tx, ivec3(texel, color_layer), 0);
    }
  }
  return color / shares;
}

vec4 depth_range(ivec2 square, int layer)
{
  float covered = 0.0, depth = 0.0, shares = 0.0;
  vec2 range = vec2(2.0, -1.0);
  ivec2 texel;
  for (int i = 0; i < 4; i++) {
    if (!part_of(square, i, texel)) {
      continue;
    }
    shares += 1.0;
    if (level > 1) {
      vec4 part = imageLoad(ranges_img, ivec3(from + texel, layer));
      covered += part.w;
      depth += part.w * part.z;
      range = vec2(min(range.x, part.x), max(range.y, part.y));
      continue;
    }
    ivec3 place = ivec3(texel, layer);
    vec2 found = texelFetch(depths_tx, place, 0).xy;
    float z = found.x;
    if (z <= 1.0) {
      float share = (alpha_covers == 1) ? clamp(texelFetch(colors_tx, place, 0).a, 0.0, 1.0) : found.y;
      covered += share;
      depth += share * z;
      range = vec2(min(range.x, z), max(range.y, z));
    }
  }
  return vec4(range, (covered > 0.0) ? depth / covered : 2.0, covered / shares);
}

void main()
{
  ivec3 square = ivec3(gl_GlobalInvocationID);
  size = textureSize(depths_tx, 0).xy;
  if (any(greaterThanEqual(square.xy, level_size(size, level)))) {
    return;
  }
  below = level_size(size, level - 1);
  from = level_origin(size, level - 1);
  ivec2 to = level_origin(size, level) + square.xy;
  imageStore(ranges_img, ivec3(to, square.z), depth_range(square.xy, square.z));
  int layers = textureSize(depths_tx, 0).z;
  for (int eye = 0; eye < eyes; eye++) {
    int color_layer = square.z + eye * layers;
    imageStore(means_img, ivec3(to, color_layer), mean_color(square.xy, square.z, color_layer));
  }
}
