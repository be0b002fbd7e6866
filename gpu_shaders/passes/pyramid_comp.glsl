// One level of the mip pyramid of a lens sample: mean colour and depth range over squares of texels,
// each twice as wide as in the level before.
// Inputs: sample_tx, depth_tx; level (that is made, from 1 on); means (number of levels of mean
// colours); film (texels of the sample).
// Outputs: means_img, ranges_img, layer level - 1, at their lower left corner.
#include "lib/extremes_lib.glsl"

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  ivec2 below = (film + (1 << (level - 1)) - 1) >> (level - 1);
  if (any(greaterThanEqual(texel, (below + 1) / 2))) {
    return;
  }
  bool mixes = level <= means;
  vec4 sum = vec4(0.0);
  vec2 range = vec2(1.0, 0.0);
  for (int i = 0; i < 4; i++) {
    // The last square of an odd row holds its last texel twice.
    ivec2 from = min(2 * texel + ivec2(i & 1, i >> 1), below - 1);
    if (level == 1) {
      sum += mixes ? texelFetch(sample_tx, from, 0) : vec4(0.0);
      range = extremes(range, vec2(texelFetch(depth_tx, from, 0).x));
    }
    else {
      sum += mixes ? imageLoad(means_img, ivec3(from, level - 2)) : vec4(0.0);
      range = extremes(range, imageLoad(ranges_img, ivec3(from, level - 2)).xy);
    }
  }
  if (mixes) {
    imageStore(means_img, ivec3(texel, level - 1), 0.25 * sum);
  }
  imageStore(ranges_img, ivec3(texel, level - 1), vec4(range, 0.0, 0.0));
}
