// Projection of a point onto the lens, seen from a source, into the source's tile of the atlas.
#ifndef TILE_LIB_GLSL
#define TILE_LIB_GLSL
#include "lib/bokeh/source_lib.glsl"

// tile: x, y, side, texels. Clip distances cut off what lies beyond the tile's sides, in front of the
// clip start or behind the source's own surface: otherwise a floor would cover the whole atlas.
vec4 tile_project(Source source, vec4 tile, vec3 eye)
{
  vec3 lens = cone_project(source.cone, eye, visibility_buf.opening.xy);
  float z = -eye.z;
  gl_ClipDistance[0] = lens.z - lens.x;
  gl_ClipDistance[1] = lens.z + lens.x;
  gl_ClipDistance[2] = lens.z - lens.y;
  gl_ClipDistance[3] = lens.z + lens.y;
  gl_ClipDistance[4] = z - visibility_buf.opening.z;
  gl_ClipDistance[5] = source.hides - z;
  vec2 low = tile.xy / layout_buf.atlas.xy * 2.0 - 1.0;
  vec2 half_side = tile.z / layout_buf.atlas.xy;
  return vec4((low + half_side) * lens.z + half_side * lens.xy, 0.0, lens.z);
}

#endif
