// Nearest and farthest depth that can reach a pixel through any place on the lens: from the bounds
// of the whole picture to those inside the largest circle of confusion they allow, again and again.
// Inputs: levels_tx (N-buffers of the depth seen from the lens' centre); sweep; opening (half width
// and height of the opening, m; z, w: least and largest depth of the picture).
// Outputs: nearest (x) and farthest (y) depth buffer value.
// Source: methods 6; Lee, Eisemann and Seidel, SIGGRAPH 2010.
#include "lib/nbuffer_lib.glsl"
#include "lib/sweep_lib.glsl"

// The bounds hardly shrink after the third time.
#define ITERATIONS 3

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 bounds = opening.zw;
  for (int i = 0; i < ITERATIONS; i++) {
    vec2 reach = max(abs(sweep_px(opening.xy, sweep, bounds.x)),
                     abs(sweep_px(opening.xy, sweep, bounds.y)));
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
