// Projects the triangles of a cluster from a source onto the lens.
// Inputs: corner (of PAIRS_A_DRAW clusters); count (of pairs); pairs_tx (source, row of the instance table, cluster); sources_tx,
// tiles_tx, instances_tx, corners_tx (see engine/drawing/occluders.py); visibility_buf, layout_buf.
// Outputs: v_tile (x, y, side of the source's mask, texels).
// Source: methods 11 (J20 section 4.2).
#include "lib/surface/instance_lib.glsl"
#include "lib/tile_lib.glsl"

void main()
{
  int number = gl_InstanceID * PAIRS_A_DRAW + int(corner) / CLUSTER_CORNERS;
  if (number >= count) {
    // Nothing: a triangle without area.
    v_tile = vec3(0.0);
    gl_ClipDistance[0] = -1.0;
    gl_ClipDistance[1] = -1.0;
    gl_ClipDistance[2] = -1.0;
    gl_ClipDistance[3] = -1.0;
    gl_ClipDistance[4] = -1.0;
    gl_ClipDistance[5] = -1.0;
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
    return;
  }
  vec4 pair = texelFetch(pairs_tx, list_texel(number), 0);
  ivec2 texel = list_texel(int(pair.x));
  Source source = source_of(texelFetch(sources_tx, texel, 0), visibility_buf);
  vec4 tile = texelFetch(tiles_tx, texel, 0);
  int cluster = int(pair.z);
  ivec2 place = ivec2((cluster % CLUSTERS_PER_ROW) * CLUSTER_CORNERS +
                          int(corner) % CLUSTER_CORNERS,
                      cluster / CLUSTERS_PER_ROW);
  vec4 position = vec4(texelFetch(corners_tx, place, 0).xyz, 1.0);
  mat4 world = instance_world(instances_tx, int(pair.y));
  v_tile = tile.xyz;
  gl_Position = tile_project(source, tile, (visibility_buf.view * (world * position)).xyz);
}
