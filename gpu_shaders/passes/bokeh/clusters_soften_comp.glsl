// Blurs the visibility masks of merged sources by the parallax of their occluders, see
// lib/bokeh/occluder_blur_lib.glsl.
// A group of threads for each source. The occluders' mean blur was found by the test of the source's
// cone; LAYERS: it is found by samples of the peeled layers around the source, the denser the nearer.
// Inputs: sources_tx, tiles_tx, states_tx (see bokeh_culling_comp), masks_tx; visibility_buf; count.
// LAYERS: layers_tx.
// Outputs: soft_img, the atlas with blurred masks; other texels are not written.
// Source: J-D section 5.1.2.
#include "lib/bokeh/occluder_blur_lib.glsl"

#define SIDE 8
#define SCALES 4
#define TAPS 4
// Least blur that is applied, texels: below, the interpolation of the mask suffices.
#define LEAST_TEXELS 0.5

#ifdef LAYERS
float depth_of(float value)
{
  float rate = visibility_buf.sweep.w;
  float from = value - visibility_buf.sweep.z;
  return (visibility_buf.lens.y > 0.5) ? from / rate : rate / from;
}

// Weighted blur and weight of the occluders that a thread's samples find.
vec2 sample_occluders(Source source, float extent, float nearest, ivec2 lane)
{
  vec2 found = vec2(0.0);
  vec2 rate = source_reach(visibility_buf);
  vec2 reach = rate * max(source.depth - nearest, 0.0);
  for (int scale = 0; scale < SCALES; scale++) {
    float size = exp2(-float(scale));
    vec2 offset = ((vec2(lane) + 0.5) / float(SIDE) * 2.0 - 1.0) * reach * size;
    vec4 values = visibility_layers(layers_tx, source.place + offset);
    for (int k = 0; k < 4; k++) {
      float way = source.depth - values[k];
      vec2 spread = rate * way;
      // The occluder hides a part of the lens.
      if (values[k] < source.limit && way > 0.0 && length(offset / spread) <= 1.0) {
        float weight = (reach.x * reach.y * size * size) / max(spread.x * spread.y, 1e-12);
        found += weight * vec2(occluder_blur(source, extent, depth_of(values[k]), visibility_buf), 1.0);
      }
    }
  }
  return found;
}
#endif

void main()
{
  int index = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x);
  ivec2 lane = ivec2(gl_LocalInvocationID.xy);
  ivec2 texel = list_texel(min(index, count - 1));
  vec4 tile = texelFetch(tiles_tx, texel, 0);
  vec4 a = texelFetch(sources_tx, texel, 0);
  Source source = source_of(a, visibility_buf);
  bool masked = index < count && tile.w == SOURCE_MASKED;
  vec4 record = texelFetch(states_tx, texel, 0);
#ifdef LAYERS
  int number = lane.x + lane.y * SIDE;
  blurs[number] = masked ? sample_occluders(source, a.w, record.x, lane) : vec2(0.0);
  barrier();
  vec2 sum = vec2(0.0);
  for (int i = 0; i < SIDE * SIDE; i++) {
    sum += blurs[i];
  }
#else
  vec2 sum = record.yz;
#endif
  if (!masked) {
    return;
  }
  float width = sum.x / max(sum.y, 1e-20);
  bool sharp = width * 0.5 * tile.z < LEAST_TEXELS;
  for (int y = lane.y; y < int(tile.z); y += SIDE) {
    for (int x = lane.x; x < int(tile.z); x += SIDE) {
      vec2 lens = (vec2(x, y) + 0.5) / tile.z * 2.0 - 1.0;
      float seen = 0.0;
      for (int tap = 0; tap < TAPS * TAPS && !sharp; tap++) {
        vec2 place = (vec2(tap % TAPS, tap / TAPS) + 0.5) / float(TAPS) - 0.5;
        seen += visibility_mask(masks_tx, tile.xyz, lens + width * place) / float(TAPS * TAPS);
      }
      seen = sharp ? visibility_mask(masks_tx, tile.xyz, lens) : seen;
      imageStore(soft_img, ivec2(tile.xy) + ivec2(x, y), vec4(seen));
    }
  }
}
