// The light that a lens lets through at the places of a picture, from a table of nodes.
#ifndef LIGHT_TABLE_LIB_GLSL
#define LIGHT_TABLE_LIB_GLSL
#include "lib/lens_sets_lib.glsl"

// `place` in the picture, 0 to 1; `table`: columns and rows of a table, number of tables one above the
// other, and which one. Nodes lie on the picture's edges.
vec4 light_at(sampler2D light_tx, vec2 place, vec4 table)
{
  vec2 node = clamp(place, 0.0, 1.0) * (table.xy - 1.0);
  node.y += table.w * table.y;
  return textureLod(light_tx, (node + 0.5) / vec2(table.x, table.z * table.y), 0.0);
}

// As `light_at`, with a table for each set of places on the lens, one above the other from `table.w` on,
// if there are several.
vec4 light_at_pixel(sampler2D light_tx, vec2 place, vec4 table, int sets, ivec2 pixel)
{
  return light_at(light_tx, place, table + vec4(0.0, 0.0, 0.0, (sets > 1) ? lens_set(pixel) : 0));
}

#endif
