// The picture: the sum of the samples over their weight, placed at an offset in the target,
// each pixel as a square of pixel_size.
// Inputs: sum_tx; scale (1 / summed weight; CHROMATIC: of each channel); origin (lower left corner in the target, px);
// pixel_size.
// Outputs: premultiplied scene-linear colour. Source: methods 1.
void main()
{
  out_color = texelFetch(sum_tx, (ivec2(gl_FragCoord.xy) - origin) / pixel_size, 0) * scale;
}
