// The pyramid of means of the picture as the lens' middle sees it (surroundings_comp): r mean brightness
// of what is no nearer than some depth, times g, the share of the square that it fills; b the largest
// circle of confusion, px, signed: that of what is farthest.
#ifndef MEANS_LIB_GLSL
#define MEANS_LIB_GLSL
#include "lib/pyramid_atlas_lib.glsl"

// Side of the square with the area of a circle, in radii.
#define SQUARE_OF_CIRCLE 1.7724539
// Share of a circle of which the brightness must be known.
#define ENOUGH 0.25
// Parallax, px, against what is in front of a point from which on that can hide it, and least distance,
// px, in which it is asked what is in front.
#define IN_FRONT 0.1
#define SLOPED 3.0

// Brightness and share of a square of the picture, between the texels of a level. `at` in px.
vec2 mean_of_level(vec2 at, int level, ivec2 size, sampler2D means_tx)
{
  vec2 inside = clamp(at * exp2(-float(level)), vec2(0.5), vec2(level_size(size, level)) - 0.5);
  return texture(means_tx, (inside + vec2(level_origin(size, level))) / vec2(textureSize(means_tx, 0))).rg;
}

// Mean brightness within a circle of the radius `coc_px`, or a larger one where too little of it is
// known; below 0 where nothing is.
float mean_in_circle(vec2 at, float coc_px, ivec2 size, int last, sampler2D means_tx)
{
  float level = clamp(log2(max(abs(coc_px), 1e-3) * SQUARE_OF_CIRCLE), 1.0, float(last));
  vec2 found = vec2(0.0);
  for (; found.y < ENOUGH; level += 1.0) {
    int lower = min(int(level), last);
    vec2 larger = mix(mean_of_level(at, lower, size, means_tx),
                      mean_of_level(at, min(lower + 1, last), size, means_tx), fract(level));
    float missing = (found.y > 0.0) ? (ENOUGH - found.y) / max(larger.y, 1e-6) : 1.0;
    found += larger * min(missing, 1.0);
    if (lower == last) {
      break;
    }
  }
  return (found.y > 0.0) ? found.x / found.y : -1.0;
}

// Whether a point is hidden from the whole lens, as far as the lens' middle can tell: wherever the lens
// could see it, the picture shows something in front of it.
bool hidden_from_lens(vec2 at, float coc_px, ivec2 size, int last, sampler2D means_tx)
{
  at = clamp(at, vec2(0.0), vec2(size));
  ivec2 own = min(ivec2(at) / 2, level_size(size, 1) - 1);
  float front = texelFetch(means_tx, level_origin(size, 1) + own, 0).b;
  if (front > coc_px - IN_FRONT) {
    return false;
  }
  // As far as it moves against what is in front, and as far as that may be sloped.
  float reach = max(coc_px - front, SLOPED);
  int level = clamp(int(log2(reach)), 1, last);
  float side = exp2(float(level));
  ivec2 middle = ivec2(at / side), end = level_size(size, level) - 1;
  for (int i = 0; i < 25; i++) {
    ivec2 square = middle + ivec2(i % 5 - 2, i / 5 - 2);
    vec2 low = vec2(square) * side;
    ivec2 texel = level_origin(size, level) + clamp(square, ivec2(0), end);
    if (distance(clamp(at, low, low + side), at) < reach &&
        texelFetch(means_tx, texel, 0).b > coc_px - IN_FRONT)
    {
      return false;
    }
  }
  return true;
}

#endif
