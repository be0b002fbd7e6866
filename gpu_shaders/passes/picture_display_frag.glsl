// The picture as it is displayed: sRGB-encoded and clipped, so that errors count as they are seen.
// Inputs: sum_tx, scales_tx (1 / summed weight of each channel, see tile_scale_lib); with BOKEH
// also bokeh_tx, which is added.
// Outputs: encoded colour and alpha, 0 to 1. Source: IEC 61966-2-1.
#include "lib/tile_scale_lib.glsl"

void main()
{
  ivec2 texel = ivec2(gl_FragCoord.xy);
  vec4 color = texelFetch(sum_tx, texel, 0) * tile_scale(scales_tx, texel);
#ifdef BOKEH
  color += texelFetch(bokeh_tx, texel, 0);
#endif
  // NaN is black, as in the comparison of two files.
  color = mix(clamp(color, 0.0, 1.0), vec4(0.0), isnan(color));
  vec3 encoded = 1.055 * pow(max(color.rgb, vec3(1e-9)), vec3(1.0 / 2.4)) - 0.055;
  out_color = vec4(mix(encoded, 12.92 * color.rgb, lessThanEqual(color.rgb, vec3(0.0031308))),
                   color.a);
}
