// Puts a drawn slice of the scene into a layer: colours as they are, depths in the depth buffer's
// values of the whole frame.
// Inputs: color_tx, depth_tx, MATTES: mattes_tx (the slice's); layer; color_layer (that of its colour);
// slice, whole (rows of the projections that make clip z and w of z in camera space: z's factor and
// offset, w's factor and offset).
// Outputs: colors_img, depths_img, MATTES: mattes_img; a texel without a surface has depth 2.

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, textureSize(depth_tx, 0)))) {
    return;
  }
  float seen = texelFetch(depth_tx, texel, 0).x;
  float depth = 2.0;
  if (seen < 1.0) {
    float ndc = 2.0 * seen - 1.0;
    float z = (ndc * slice.w - slice.y) / (slice.x - ndc * slice.z);
    depth = 0.5 * (whole.x * z + whole.y) / (whole.z * z + whole.w) + 0.5;
  }
  ivec3 place = ivec3(texel, layer);
  imageStore(colors_img, ivec3(texel, color_layer), clamp(texelFetch(color_tx, texel, 0), -65504.0, 65504.0));
  imageStore(depths_img, place, vec4(depth, 0.0, 0.0, 0.0));
#ifdef MATTES
  imageStore(mattes_img, place, texelFetch(mattes_tx, texel, 0));
#endif
}
