// Estimated error of a picture, from its change since an earlier one: in a window every STRIDE px, the
// structural similarity (SSIM) with a picture that differs from it by the square root of `rest` times
// that change.
// Inputs: picture_tx, earlier_tx (as displayed); rest (variance of the error over that of the change).
// Outputs: x: 1 - SSIM; y: variance of the change.
// Source: Wang et al., IEEE TIP 13(4), 2004 (Gaussian window, sigma 1.5 px, 11 x 11 px).

#define C1 0.0001
#define C2 0.0009

float worst(vec4 value)
{
  return max((value.r + value.g + value.b) / 3.0, value.a);
}

void main()
{
  ivec2 size = textureSize(picture_tx, 0);
  ivec2 center = ivec2(gl_FragCoord.xy) * STRIDE + STRIDE / 2;
  // Windows lie inside the picture if it is large enough.
  for (int axis = 0; axis < 2; axis++) {
    if (size[axis] > 2 * RADIUS) {
      center[axis] = clamp(center[axis], RADIUS, size[axis] - 1 - RADIUS);
    }
  }
  float total = 0.0;
  vec4 mean_x = vec4(0.0), mean_d = vec4(0.0), square_x = vec4(0.0), square_d = vec4(0.0);
  for (int j = -RADIUS; j <= RADIUS; j++) {
    for (int i = -RADIUS; i <= RADIUS; i++) {
      ivec2 texel = clamp(center + ivec2(i, j), ivec2(0), size - 1);
      float weight = exp(-float(i * i + j * j) / (2.0 * 1.5 * 1.5));
      vec4 x = texelFetch(picture_tx, texel, 0);
      vec4 d = x - texelFetch(earlier_tx, texel, 0);
      total += weight;
      mean_x += weight * x;
      mean_d += weight * d;
      square_x += weight * x * x;
      square_d += weight * d * d;
    }
  }
  mean_x /= total;
  mean_d /= total;
  vec4 spread = max(square_x / total - mean_x * mean_x, 0.0);
  vec4 change = max(square_d / total - mean_d * mean_d, 0.0);
  // The converged picture has no noise, so its variance is less by that of the error.
  vec4 noise = rest * change, shift = rest * mean_d * mean_d;
  vec4 structure = noise / (spread + max(spread - noise, 0.0) + C2);
  vec4 level = shift / (mean_x * mean_x + max(mean_x * mean_x - shift, 0.0) + C1);
  vec4 error = 1.0 - (1.0 - min(structure, 1.0)) * (1.0 - min(level, 1.0));
  out_color = vec4(worst(error), worst(change), 0.0, 0.0);
}
