// Projects an instance of a transparent surface from a source onto the lens.
// Inputs: mesh attributes; pairs_tx (source, row of the instance table), instance_base (first pair);
// sources_tx, tiles_tx, instances_tx; visibility_buf, layout_buf.
// Outputs: the varyings of surface_vert, and v_tile (x, y, side of the mask, texels).
// Source: methods 11.
#include "lib/surface/instance_lib.glsl"
#include "lib/tile_lib.glsl"

void main()
{
  vec4 pair = texelFetch(pairs_tx, list_texel(instance_base + gl_InstanceID), 0);
  ivec2 texel = list_texel(int(pair.x));
  Source source = source_of(texelFetch(sources_tx, texel, 0), visibility_buf);
  vec4 tile = texelFetch(tiles_tx, texel, 0);
  instance_row = int(pair.y);
  mat4 world = instance_world(instances_tx, instance_row);
  vec4 position = world * vec4(pos, 1.0);
  world_position = position.xyz;
#ifdef HAS_NORMAL
  world_normal = mat3(world) * ATTRIBUTE_NORMAL;
#endif
  v_tile = tile.xyz;
  gl_Position = tile_project(source, tile, (visibility_buf.view * position).xyz);
  forward_attributes();
}
