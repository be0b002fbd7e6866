// Two ranks of a Cryptomatte: the ids of a pixel by falling coverage, the earlier slot first where
// two are equal.
// Inputs: tables_tx (see cryptomatte_comp); first_layer of the kind; rank of the first of the two;
// scale (1 / samples; TILED: scales_tx, see tile_scale_lib; LIGHT: 1 / light_tx, sums of weights over
// the picture, with light_table).
// Outputs: id and coverage of a rank, and of the next; zeros where there is none.
// Source: Friedman and Jones, SIGGRAPH 2015.
#ifdef TILED
#include "lib/tile_scale_lib.glsl"
#endif
#ifdef LIGHT
#include "lib/light_table_lib.glsl"
#endif

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
#ifdef TILED
  float scale = tile_scale(scales_tx, pixel).x;
#endif
#ifdef LIGHT
  vec2 place = gl_FragCoord.xy / vec2(textureSize(tables_tx, 0).xy);
  float scale = 1.0 / light_at_pixel(light_tx, place, light_table, light_sets, pixel).w;
#endif
  vec2 slots[2 * SLOT_PAIRS];
  for (int i = 0; i < SLOT_PAIRS; i++) {
    vec4 pair = texelFetch(tables_tx, ivec3(pixel, first_layer + i), 0);
    slots[2 * i] = pair.xy;
    slots[2 * i + 1] = pair.zw;
  }
  out_color = vec4(0.0);
  for (int i = 0; i < 2 * SLOT_PAIRS; i++) {
    int place = 0;
    for (int j = 0; j < 2 * SLOT_PAIRS; j++) {
      bool before = slots[j].y > slots[i].y || (slots[j].y == slots[i].y && j < i);
      place += before ? 1 : 0;
    }
    if (slots[i].y > 0.0) {
      vec2 entry = vec2(slots[i].x, slots[i].y * scale);
      if (place == rank) {
        out_color.xy = entry;
      }
      if (place == rank + 1) {
        out_color.zw = entry;
      }
    }
  }
}
