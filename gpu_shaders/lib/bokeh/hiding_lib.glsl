// Which surfaces hide a highlight from the whole lens.
#ifndef HIDING_LIB_GLSL
#define HIDING_LIB_GLSL

#include "lib/depth_lib.glsl"
#include "lib/lens_lib.glsl"

// Least opacity of a surface that counts as an occluder.
#define OPAQUE_FROM 0.999
// Difference of circles of confusion, px, below which a surface in front hides from the whole lens.
#define SAME_VIEW 1.0
// Depth buffer values of one surface in two shaders may differ by this much.
#define DEPTH_STEPS 2e-7

// Whether all of the lens sees two depths of a depth buffer at one place; `projection` and `lens` as in
// ViewParams.
bool alike(float front, float window_depth, mat4 projection, vec4 lens)
{
  float near = coc_radius_px(depth_from_window(front, projection, lens), lens);
  float far = coc_radius_px(depth_from_window(window_depth, projection, lens), lens);
  return abs(near - far) < SAME_VIEW;
}

// Whether an opaque surface hides what lies at a depth from the whole lens.
bool hides(float front, float window_depth, mat4 projection, vec4 lens)
{
  return front < window_depth - DEPTH_STEPS && alike(front, window_depth, projection, lens);
}

#endif
