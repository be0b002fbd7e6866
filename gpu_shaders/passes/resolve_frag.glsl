// The picture: the sum of the samples over their weight, placed at an offset in the target,
// each pixel as a square of pixel_size.
// Inputs: sum_tx; with BOKEH also bokeh_tx, which is added; scale (1 / summed weight, or that of each
// channel); origin (lower left corner in the target, px); pixel_size.
// Outputs: premultiplied scene-linear colour. Source: methods 1.
void main()
{
  ivec2 texel = (ivec2(gl_FragCoord.xy) - origin) / pixel_size;
  out_color = texelFetch(sum_tx, texel, 0) * scale;
#ifdef BOKEH
  out_color += texelFetch(bokeh_tx, texel, 0);
#endif
}
