// One layer of a stack of N-buffers: layer 0 from a depth buffer, the others from the one before.
// Inputs: depth_tx; level (of the layer that is made).
// Outputs: levels_img, least (x) and largest (y) depth over the square of 2^level texels that begins
// at the texel, as far as it lies in the picture.
// Source: methods 5 (Decoret, EG 2005).
#include "lib/nbuffer_lib.glsl"

void main()
{
  ivec2 size = imageSize(levels_img).xy;
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, size))) {
    return;
  }
  vec2 result;
  if (level == 0) {
    result = vec2(texelFetch(depth_tx, texel, 0).x);
  }
  else {
    ivec2 next = min(texel + (1 << (level - 1)), size - 1);
    result = extremes(
        extremes(imageLoad(levels_img, ivec3(texel, level - 1)).xy,
                 imageLoad(levels_img, ivec3(next.x, texel.y, level - 1)).xy),
        extremes(imageLoad(levels_img, ivec3(texel.x, next.y, level - 1)).xy,
                 imageLoad(levels_img, ivec3(next, level - 1)).xy));
  }
  imageStore(levels_img, ivec3(texel, level), vec4(result, 0.0, 0.0));
}
