// Finds masks that hide everything or nothing: their sources are dropped, or need none.
// Inputs: masks_tx (the atlas); count.
// Outputs: tiles_img (kind, see bokeh_culling_tiles_comp); counts_img.
// Source: methods 10.
#include "lib/bokeh/visibility_lib.glsl"

ivec2 list_texel(int index)
{
  return ivec2(index % SOURCE_COLUMNS, index / SOURCE_COLUMNS);
}

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  if (index >= count) {
    return;
  }
  vec4 tile = imageLoad(tiles_img, list_texel(index));
  if (tile.w != SOURCE_MASKED) {
    return;
  }
  int side = int(tile.z);
  // Texels of a mask that are ever read: inside the lens, widened by the spline of three texels.
  float reach = 0.5 * tile.z + 2.13;
  int number = side * side;
  // Texels are tested in scattered order, so that most masks are decided early: an odd step that is
  // coprime to the number of texels.
  int stride = int(0.618 * float(number)) / 6 * 6 + 1;
  bool whole = true, empty = true;
  int at = number / 2 + side / 2;
  for (int i = 0; i < number && (whole || empty); i++) {
    at = (at + stride) % number;
    ivec2 place = ivec2(at % side, at / side);
    if (length(vec2(place) + 0.5 - 0.5 * tile.z) > reach) {
      continue;
    }
    float seen = texelFetch(masks_tx, ivec2(tile.xy) + place, 0).x;
    whole = whole && seen == 1.0;
    empty = empty && seen == 0.0;
  }
  if (whole) {
    imageStore(tiles_img, list_texel(index), vec4(vec3(0.0), SOURCE_UNMASKED));
    imageAtomicAdd(counts_img, ivec2(COUNT_WHOLE, 0), 1u);
  }
  else if (empty) {
    imageStore(tiles_img, list_texel(index), vec4(vec3(0.0), SOURCE_DROP));
    imageAtomicAdd(counts_img, ivec2(COUNT_EMPTY, 0), 1u);
  }
}
