// One level of the pyramids of all layers: mean colour, and least, largest and mean depth and coverage
// over squares twice as wide as in the level before.
// Inputs: colors_tx, depths_tx (the layers); level (from 1); alpha_covers (1: the colour's alpha is the
// coverage; 0: a texel with a surface is covered).
// Outputs: means_img (premultiplied colour); ranges_img (x, y: least and largest depth of what is
// covered, 2 and -1 if nothing is; z: mean depth of what is covered; w: coverage).
// Source: methods 7 (LES09 section 5); Decoret, N-buffers, EG 2005.
#include "lib/pyramid_atlas_lib.glsl"

void main()
{
  ivec3 square = ivec3(gl_GlobalInvocationID);
  ivec2 size = textureSize(depths_tx, 0).xy;
  if (any(greaterThanEqual(square.xy, level_size(size, level)))) {
    return;
  }
  ivec2 below = level_size(size, level - 1), from = level_origin(size, level - 1);
  vec4 color = vec4(0.0);
  float covered = 0.0, depth = 0.0, shares = 0.0;
  vec2 range = vec2(2.0, -1.0);
  for (int i = 0; i < 4; i++) {
    ivec2 texel = 2 * square.xy + ivec2(i & 1, i >> 1);
    if (any(greaterThanEqual(texel, below))) {
      continue;
    }
    shares += 1.0;
    if (level == 1) {
      ivec3 place = ivec3(texel, square.z);
      float z = texelFetch(depths_tx, place, 0).x;
      vec4 light = texelFetch(colors_tx, place, 0);
      if (z <= 1.0) {
        float share = (alpha_covers == 1) ? clamp(light.a, 0.0, 1.0) : 1.0;
        covered += share;
        depth += share * z;
        color += light;
        range = vec2(min(range.x, z), max(range.y, z));
      }
    }
    else {
      ivec3 place = ivec3(from + texel, square.z);
      vec4 part = imageLoad(ranges_img, place);
      covered += part.w;
      depth += part.w * part.z;
      color += imageLoad(means_img, place);
      range = vec2(min(range.x, part.x), max(range.y, part.y));
    }
  }
  ivec3 to = ivec3(level_origin(size, level) + square.xy, square.z);
  float mean = (covered > 0.0) ? depth / covered : 2.0;
  imageStore(means_img, to, color / shares);
  imageStore(ranges_img, to, vec4(range, mean, covered / shares));
}
