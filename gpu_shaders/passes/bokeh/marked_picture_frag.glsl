// The picture, dimmed, below marks; placed at an offset in the target, each pixel as a square of
// pixel_size.
// Inputs: picture_tx, marks_tx (premultiplied); origin (lower left corner in the target, px);
// pixel_size.
// Outputs: premultiplied scene-linear colour. Source: methods 10.

// Brightness of the dimmed picture: factor, and maximum.
#define DIMMED 0.25

void main()
{
  ivec2 texel = (ivec2(gl_FragCoord.xy) - origin) / pixel_size;
  vec4 picture = texelFetch(picture_tx, texel, 0);
  vec4 marks = texelFetch(marks_tx, texel, 0);
  // Clamped, so that marks can be seen on bright discs.
  float peak = max(picture.r, max(picture.g, picture.b));
  picture.rgb *= DIMMED / max(peak, 1.0);
  out_color = marks + picture * (1.0 - marks.a);
}
