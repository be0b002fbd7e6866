// Copies a list of highlights into a larger one.
// Inputs: from_tx.
// Outputs: to_img, its first rows.
// Source: methods 9.

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (texel.y < textureSize(from_tx, 0).y) {
    imageStore(to_img, texel, texelFetch(from_tx, texel, 0));
  }
}
