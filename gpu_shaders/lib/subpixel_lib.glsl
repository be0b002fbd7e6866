// A pixel as a grid of SUBPIXELS x SUBPIXELS sub-pixels, weighted by column and row.
#ifndef SUBPIXEL_LIB_GLSL
#define SUBPIXEL_LIB_GLSL

float subpixel_weight(ivec2 place, vec4 columns, vec4 rows)
{
  return columns[place.x] * rows[place.y];
}

// Weighted sum over a pixel's sub-pixels.
vec4 subpixel_sum(sampler2D raster_tx, ivec2 pixel, vec4 columns, vec4 rows)
{
  vec4 total = vec4(0.0);
  for (int y = 0; y < SUBPIXELS; y++) {
    for (int x = 0; x < SUBPIXELS; x++) {
      vec4 value = texelFetch(raster_tx, pixel * SUBPIXELS + ivec2(x, y), 0);
      total += subpixel_weight(ivec2(x, y), columns, rows) * value;
    }
  }
  return total;
}

#endif
