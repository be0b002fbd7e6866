// The picture: the sum of the samples over their weight, placed at an offset in the target,
// each pixel as a square of pixel_size.
// Inputs: sum_tx; with BOKEH also bokeh_tx, which is added; scale (1 / summed weight, or that of each
// channel; TILED: scales_tx, see tile_scale_lib;
// LIGHT: 1 / light_tx, sums of weights over the picture, with light_table and light_sets); origin (lower
// left corner in the target, px); pixel_size. DISTORTED: the textures are of a raster without distortion,
// sampled where the picture's pixels lie in it; to_field, from_field, terms, model (see distortion_lib).
// Outputs: premultiplied scene-linear colour. Source: methods 1, 13.
#ifdef DISTORTED
#include "lib/distortion_lib.glsl"
#endif
#ifdef TILED
#include "lib/tile_scale_lib.glsl"
#endif
#ifdef LIGHT
#include "lib/light_table_lib.glsl"
#endif

void main()
{
  ivec2 texel = (ivec2(gl_FragCoord.xy) - origin) / pixel_size;
#ifdef DISTORTED
  Distorted at = distorted_place(vec2(texel) + 0.5, to_field, from_field, terms, model);
  out_color = distorted_sample(sum_tx, at) * scale;
#ifdef BOKEH
  out_color += distorted_sample(bokeh_tx, at);
#endif
#else
#ifdef TILED
  vec4 scale = tile_scale(scales_tx, texel);
#endif
#ifdef LIGHT
  vec2 place = (vec2(texel) + 0.5) / vec2(textureSize(sum_tx, 0));
  vec4 scale = 1.0 / light_at_pixel(light_tx, place, light_table, light_sets, texel);
#endif
  out_color = texelFetch(sum_tx, texel, 0) * scale;
#ifdef BOKEH
  out_color += texelFetch(bokeh_tx, texel, 0);
#endif
#endif
}
