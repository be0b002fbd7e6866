// Marks the sources that need a mask, by size, and counts the sources by state.
// Inputs: sources_tx; states_tx; visibility_buf; count; rows (of a segment of keys); kinds (segments
// of masks; more than SIZES: those that are decided have masks, too, behind the others).
// Outputs: keys_img: 1 where the source has a mask of the segment's size; counts_img: sources by
// state, masks by size, 64ths of texels times steps.
// Source: methods 10.
#include "lib/bokeh/source_lib.glsl"

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  ivec2 texel = list_texel(index);
  if (texel.y >= rows) {
    return;
  }
  vec4 record = index < count ? texelFetch(states_tx, texel, 0) : vec4(0.0);
  bool open = record.w == STATE_OPEN;
  bool masked = index < count && (open || kinds > SIZES);
  Source source = source_of(texelFetch(sources_tx, texel, 0), visibility_buf);
  int size = source_class(source.coc, visibility_buf) + (open ? 0 : SIZES);
  for (int k = 0; k < kinds; k++) {
    imageStore(keys_img, texel + ivec2(0, k * rows), uvec4(masked && k == size ? 1u : 0u));
  }
  if (index >= count) {
    return;
  }
  imageAtomicAdd(counts_img, ivec2(int(record.w), 0), 1u);
  if (masked) {
    imageAtomicAdd(counts_img, ivec2(COUNT_SIZES + size, 0), 1u);
  }
  if (open) {
    vec2 rate = source_reach(visibility_buf);
    float steps = 0.5 * max(rate.x, rate.y) * max(source.depth - record.x, 0.0);
    float side = visibility_buf.tiles.y * exp2(float(size));
    float walked = 1.0 + min(steps, float(VISIBILITY_STEPS));
    uint work = uint(ceil(side * side * walked / 64.0));
    imageAtomicAdd(counts_img, ivec2(COUNT_WORK, 0), work);
  }
}
