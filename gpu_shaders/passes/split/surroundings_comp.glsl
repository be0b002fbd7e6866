// Mean brightness around each place of the picture, at one of the depths of threshold_lib.
// LEVEL: one level of a pyramid of means of what is no nearer than the next depth; the first is that of
// the picture as the lens' middle sees it, at half its resolution. With CLIPPED, of what is brighter than
// the threshold of surroundings found before only the threshold is counted: light that is splatted is
// nothing that hides the noise of other light.
// Otherwise: from the pyramid, the mean within the circle of confusion that the depth has, or where
// nothing is so far, what was found for the next depth.
// Inputs: depth, size (of the picture, px), highlight_buf. LEVEL: level (that is made, from 1 on), view_buf,
// color_tx (scene linear), depth_tx (window depth), CLIPPED: before_tx. Otherwise: means_tx.
// Outputs: means_img (see lib/split/means_lib.glsl); or surroundings_img (four depths, and on their right
// the other four), of which the nearer ones are known.
#include "lib/split/threshold_lib.glsl"
#include "lib/split/means_lib.glsl"
#include "lib/depth_lib.glsl"
#include "lib/lens_lib.glsl"

// Of half precision.
#define BRIGHTEST 60000.0

#ifdef LEVEL
float coc_of(ivec2 texel)
{
  float window_depth = texelFetch(depth_tx, texel, 0).x;
  float depth = (window_depth < 1.0) ?
                    depth_from_window(window_depth, view_buf.projection, view_buf.lens) :
                    highlight_buf.world.x;
  return coc_radius_px(depth, view_buf.lens);
}

float brightness(ivec2 texel, float coc)
{
  vec3 color = texelFetch(color_tx, texel, 0).rgb;
  float peak = max(color.r, max(color.g, color.b));
  // Neither negative light nor what is no number.
  peak = (peak > 0.0) ? min(peak, BRIGHTEST) : 0.0;
#ifdef CLIPPED
  vec2 place = (vec2(texel) + 0.5) * 4.0 / vec2(size) - 1.0;
  peak = min(peak, highlight_threshold(place, coc, highlight_buf, before_tx));
#endif
  return peak;
}

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, level_size(size, level)))) {
    return;
  }
  vec4 mean = vec4(0.0, 0.0, -BRIGHTEST, 0.0);
  if (level == 1) {
    float coc = clamp(coc_of(texel), -BRIGHTEST, BRIGHTEST);
    float share = (highlight_buf.split.w - coc <= parallax_of_depth(depth + 1)) ? 1.0 : 0.0;
    mean = vec4(share * brightness(texel, coc), share, coc, 0.0);
  }
  else {
    ivec2 last = level_size(size, level - 1) - 1, from = level_origin(size, level - 1);
    for (int i = 0; i < 4; i++) {
      // The last square of an odd row holds its last texel twice.
      vec4 part = imageLoad(means_img, from + min(2 * texel + ivec2(i & 1, i >> 1), last));
      mean.rg += 0.25 * part.rg;
      mean.b = max(mean.b, part.b);
    }
  }
  imageStore(means_img, level_origin(size, level) + texel, mean);
}
#else
void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), texels = level_size(size, 1);
  if (any(greaterThanEqual(texel, texels))) {
    return;
  }
  float coc = highlight_buf.split.w - parallax_of_depth(depth);
  int last = int(highlight_buf.automatic.y);
  float mean = mean_in_circle(2.0 * (vec2(texel) + 0.5), coc, size, last, means_tx);
  ivec2 right = ivec2(texels.x, 0), to = texel + ((depth < 4) ? ivec2(0) : right);
  vec4 found = imageLoad(surroundings_img, to);
  if (mean < 0.0) {
    // All is known for the nearest depth.
    vec4 nearer = imageLoad(surroundings_img, texel + ((depth < 3) ? ivec2(0) : right));
    mean = nearer[(depth + 1) % 4];
  }
  found[depth % 4] = mean;
  imageStore(surroundings_img, to, found);
}
#endif
