// Counts the ids of one lens sample in each pixel's tables: the slot that has the id counts one more;
// else a free slot takes it; else the slot that counted least is handed over with its count, so
// that a table's total stays the number of samples that hit something.
// Inputs: mattes_tx (ids by channel; 0 is nothing; SUBPIXELS times as large as the tables); kinds;
// channels (channel of each kind's id); columns, rows (weights of sub-pixels). TILED: active_tx (1 for
// the tiles of TILE pixels that the sample is drawn for, else 0).
// LIGHT: light_tx, light_table (weights of the sample over the picture).
// Outputs: tables_img, layers of two slots (id, count, id, count), SLOT_PAIRS layers a kind.
// Source: Friedman and Jones, SIGGRAPH 2015; replacement after Metwally et al., Efficient
// computation of frequent and top-k elements in data streams, ICDT 2005 (space saving).

#include "lib/subpixel_lib.glsl"
#ifdef LIGHT
#include "lib/light_table_lib.glsl"
#endif

void count_id(ivec2 pixel, int first_layer, float id, float weight)
{
  float least = 3.0e38;
  int least_slot = 0;
  vec4 least_pair = vec4(0.0);
  for (int i = 0; i < SLOT_PAIRS; i++) {
    vec4 pair = imageLoad(tables_img, ivec3(pixel, first_layer + i));
    for (int j = 0; j < 2; j++) {
      float count = (j == 0) ? pair.y : pair.w;
      float name = (j == 0) ? pair.x : pair.z;
      if (count == 0.0 || name == id) {
        pair = (j == 0) ? vec4(id, count + weight, pair.zw) : vec4(pair.xy, id, count + weight);
        imageStore(tables_img, ivec3(pixel, first_layer + i), pair);
        return;
      }
      if (count < least) {
        least = count;
        least_slot = 2 * i + j;
        least_pair = pair;
      }
    }
  }
  least_pair = (least_slot % 2 == 0) ? vec4(id, least + weight, least_pair.zw) :
                                       vec4(least_pair.xy, id, least + weight);
  imageStore(tables_img, ivec3(pixel, first_layer + least_slot / 2), least_pair);
}

void main()
{
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(mattes_tx, 0) / SUBPIXELS))) {
    return;
  }
#ifdef TILED
  if (texelFetch(active_tx, pixel / TILE, 0).x == 0.0) {
    return;
  }
#endif
  float light = 1.0;
#ifdef LIGHT
  vec2 place = (vec2(pixel) + 0.5) / vec2(textureSize(mattes_tx, 0) / SUBPIXELS);
  light = light_at_pixel(light_tx, place, light_table, light_sets, pixel).x;
#endif
  for (int y = 0; y < SUBPIXELS; y++) {
    for (int x = 0; x < SUBPIXELS; x++) {
      float weight = light * subpixel_weight(ivec2(x, y), columns, rows);
      if (weight <= 0.0) {
        continue;
      }
      vec4 ids = texelFetch(mattes_tx, pixel * SUBPIXELS + ivec2(x, y), 0);
      for (int kind = 0; kind < kinds; kind++) {
        float id = ids[channels[kind]];
        if (id != 0.0) {
          count_id(pixel, kind * SLOT_PAIRS, id, weight);
        }
      }
    }
  }
}
