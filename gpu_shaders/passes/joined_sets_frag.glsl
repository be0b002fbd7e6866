// The first picture: pixels that see through different places on the lens, joined where that changes
// nothing but their noise: what is blurred in front of the focus with all neighbours, all else among
// neighbours that see nothing sharp.
// Inputs: near_tx, others_tx, shares_tx, as subsample_frag leaves them with PIXEL_SETS; all of them textures of
// the picture's size.
// Outputs: the weighted sum of the places.
// Blur of a pixel from which on it is joined with its neighbours, texels: a square of PIXEL_SETS pixels hardly
// blurs it further.
#define JOINED 2.0

// Each place of the pattern counts once: over a square that is wider than it by one pixel, half at its
// edges.
float part_of(int offset)
{
  return (abs(offset) == PIXEL_SETS / 2) ? 0.5 : 1.0;
}

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(shares_tx, 0) - 1;
  vec4 near = vec4(0.0), others = vec4(0.0);
  float near_share = 0.0, others_share = 0.0, parts = 0.0;
  vec4 own = texelFetch(shares_tx, pixel, 0);
  bool joins = own.y >= JOINED;
  for (int y = -PIXEL_SETS / 2; y <= PIXEL_SETS / 2; y++) {
    for (int x = -PIXEL_SETS / 2; x <= PIXEL_SETS / 2; x++) {
      ivec2 texel = clamp(pixel + ivec2(x, y), ivec2(0), last);
      float part = part_of(x) * part_of(y);
      vec2 shares = texelFetch(shares_tx, texel, 0).xy;
      near += texelFetch(near_tx, texel, 0) * part;
      near_share += shares.x * part;
      parts += part;
      if (texel == pixel || (joins && shares.y >= JOINED)) {
        others += texelFetch(others_tx, texel, 0) * part;
        others_share += (1.0 - shares.x) * part;
      }
    }
  }
  near /= parts;
  near_share /= parts;
  if (others_share > 0.0) {
    out_color = near + others * ((1.0 - near_share) / others_share);
  }
  else {
    // Nothing else is seen from any place.
    out_color = near / max(near_share, 1e-6);
  }
  // What a real lens lets through changes from pixel to pixel, as the weights do that it is divided by.
  out_color *= own.z;
}
