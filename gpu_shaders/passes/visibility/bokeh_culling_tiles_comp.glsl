// Writes the kind of every source (dropped, unmasked, masked, ...) and the places of masks in the atlas.
// Inputs: sources_tx; states_tx; keys_tx, totals_tx (prefix sums); visibility_buf, layout_buf; count;
// rows (of a segment of keys); kind (of sources that need a mask); kinds (segments of masks; see
// bokeh_culling_keys_comp).
// Outputs: tiles_img: place (xy) and side (z) of the mask, kind (w); for sources that the splat casts
// rays for: x: least depth buffer value of any surface in front of the source. masked_img: sources with
// a mask, in order of size.
// Source: methods 10, 11.
#include "lib/bokeh/source_lib.glsl"

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  if (index >= count) {
    return;
  }
  ivec2 texel = list_texel(index);
  vec4 record = texelFetch(states_tx, texel, 0);
  bool open = record.w == STATE_OPEN;
  if (!open && kinds == SIZES) {
    bool seen = record.w == STATE_VISIBLE || record.w == STATE_FREE || record.w == STATE_EDGE;
    imageStore(tiles_img, texel, vec4(vec3(0.0), seen ? SOURCE_UNMASKED : SOURCE_DROP));
    return;
  }
  if (kind == int(SOURCE_IN_SPLAT)) {
    imageStore(tiles_img, texel, vec4(record.x, 0.0, 0.0, SOURCE_IN_SPLAT));
    return;
  }
  Source source = source_of(texelFetch(sources_tx, texel, 0), visibility_buf);
  int size = source_class(source.coc, visibility_buf) + (open ? 0 : SIZES);
  int row = texel.y + size * rows;
  uint rank = texelFetch(keys_tx, ivec2(texel.x, row), 0).x +
              texelFetch(totals_tx, list_texel(row), 0).x;
  // First rank, height of its first row in the atlas, side, masks a row.
  vec4 region = layout_buf.sizes[size];
  int within = int(rank) - int(region.x);
  vec2 place = vec2(within % int(region.w), within / int(region.w)) * region.z;
  imageStore(tiles_img, texel, vec4(place + vec2(0.0, region.y), region.z, SOURCE_MASKED));
  imageStore(masked_img, list_texel(int(rank)), vec4(float(index), record.x, 0.0, 0.0));
}
