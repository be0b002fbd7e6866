// Marks the sources that need a mask, by size, and counts what became of all.
// Inputs: states_tx; count; rows (of a segment of keys).
// Outputs: keys_img: 1 where the source has a mask of the segment's size; counts_img: sources by
// state, masks by size, 64ths of texels times steps.
// Source: methods 10.
#include "lib/source_lib.glsl"

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  ivec2 texel = list_texel(index);
  if (texel.y >= rows) {
    return;
  }
  vec4 record = index < count ? texelFetch(states_tx, texel, 0) : vec4(0.0);
  bool masked = record.w == STATE_OPEN;
  for (int size = 0; size < SIZES; size++) {
    bool own = masked && int(record.y) == size;
    imageStore(keys_img, texel + ivec2(0, size * rows), uvec4(own ? 1u : 0u));
  }
  if (index >= count) {
    return;
  }
  imageAtomicAdd(counts_img, ivec2(int(record.w), 0), 1u);
  if (masked) {
    imageAtomicAdd(counts_img, ivec2(COUNT_SIZES + int(record.y), 0), 1u);
    float side = visibility_buf.tiles.y * exp2(record.y);
    uint work = uint(ceil(side * side * (1.0 + 0.5 * record.z) / 64.0));
    imageAtomicAdd(counts_img, ivec2(COUNT_WORK, 0), work);
  }
}
