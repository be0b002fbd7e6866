// Depth along the optical axis from a depth buffer.
#ifndef DEPTH_LIB_GLSL
#define DEPTH_LIB_GLSL

// `lens` as in ViewParams; metres.
float depth_from_window(float window_depth, mat4 projection, vec4 lens)
{
  float z = window_depth * 2.0 - 1.0;
  if (lens.y > 0.5) {
    return (projection[3][2] - z) / projection[2][2];
  }
  return projection[3][2] / (z + projection[2][2]);
}

#endif
