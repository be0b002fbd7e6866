// Depth and opacity of one peeled layer into a channel of two textures, for rays that are cast.
// Inputs: depth_tx, color_tx (a: opacity); channel.
// Outputs: layers_img: depth buffer value, 2 where nothing is; opacity_img.
// Source: methods 11.

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, imageSize(layers_img)))) {
    return;
  }
  vec4 layers = vec4(2.0), opacities = vec4(1.0);
  if (channel > 0) {
    layers = imageLoad(layers_img, texel);
    opacities = imageLoad(opacity_img, texel);
  }
  float depth = texelFetch(depth_tx, texel, 0).x;
  layers[channel] = depth < 1.0 ? depth : 2.0;
  opacities[channel] = clamp(texelFetch(color_tx, texel, 0).a, 0.0, 1.0);
  imageStore(layers_img, texel, layers);
  imageStore(opacity_img, texel, opacities);
}
