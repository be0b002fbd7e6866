// Appends a fragment that is brighter than the threshold to the list of its texel.
// Inputs: capacity (fragments that there is room for), tile_texels (along a side of a tile).
// Outputs: used_img (number of fragments; beyond the capacity they are counted, not kept), heads_img
// (number of a texel's last fragment, from 1), light_img (light above the threshold, window depth),
// nodes_img (texel and opacity, number of the fragment before it in the texel's list, instance from
// 1, share of the light from behind that passes, as bits), tiles_img (bits of the largest threshold of a tile that has any).
// Source: Yang et al., Real-time concurrent linked list construction on the GPU, EGSR 2010.
#include "lib/bokeh/fragment_list_lib.glsl"

void append_fragment(
    ivec2 texel, vec3 light, float window_depth, bool opaque, float through, uint instance,
    float threshold)
{
  uint number = imageAtomicAdd(used_img, ivec2(0), 1u);
  if (number < uint(capacity)) {
    ivec2 place = list_texel(number);
    uint next = imageAtomicExchange(heads_img, texel, number + 1u);
    imageStore(light_img, place, vec4(light, window_depth));
    uint passed = floatBitsToUint(opaque ? 0.0 : clamp(through, 0.0, 1.0));
    imageStore(nodes_img, place, uvec4(fragment_key(texel, opaque), next, instance, passed));
    imageAtomicMax(tiles_img, texel / tile_texels, floatBitsToUint(threshold));
  }
}
