// Nearest and farthest depth that can reach a pixel through any place on the lens: from the bounds
// of the whole picture to those inside the largest circle of confusion they allow, again and again.
// Inputs: levels_tx (N-buffers of the depth seen from the lens' centre); sweep; opening (half width
// and height of the opening, m; z, w: least and largest depth of the picture).
// CHROMATIC: chromatic_buf, field_tx, gain (of the sweep, by 1 / focus distance).
// Outputs: nearest (x) and farthest (y) depth buffer value.
// Source: methods 6; Lee, Eisemann and Seidel, SIGGRAPH 2010.
#include "lib/nbuffer_lib.glsl"
#include "lib/sweep_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif

// The bounds hardly shrink after the third time.
#define ITERATIONS 3

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 bounds = opening.zw;
#ifdef CHROMATIC
  // Of all wavelengths: those with the shortest and the longest focal length lie at the ends.
  vec2 place = gl_FragCoord.xy * chromatic_buf.raster.xy + chromatic_buf.raster.zw;
  vec2 strengths = field_strengths(field_tx, place, chromatic_buf);
  vec4 nearer = sweep + gain * chromatic_focus(chromatic_buf.extremes.x, strengths.x, chromatic_buf);
  vec4 farther = sweep +
                 gain * chromatic_focus(chromatic_buf.extremes.y, strengths.x, chromatic_buf);
  vec2 aside = abs(place / chromatic_buf.raster.xy) * chromatic_buf.extremes.z * abs(strengths.y);
#endif
  for (int i = 0; i < ITERATIONS; i++) {
#ifdef CHROMATIC
    vec2 reach = max(max(abs(sweep_px(opening.xy, nearer, bounds.x)),
                         abs(sweep_px(opening.xy, nearer, bounds.y))),
                     max(abs(sweep_px(opening.xy, farther, bounds.x)),
                         abs(sweep_px(opening.xy, farther, bounds.y)))) +
                 aside;
#else
    vec2 reach = max(abs(sweep_px(opening.xy, sweep, bounds.x)),
                     abs(sweep_px(opening.xy, sweep, bounds.y)));
#endif
    // One more for the sub-pixel movement.
    int texels = int(ceil(max(reach.x, reach.y))) + 1;
    vec2 inside = nbuffer_extremes(levels_tx, pixel, texels);
    if (inside == bounds) {
      break;
    }
    bounds = inside;
  }
  out_bounds = bounds;
}
