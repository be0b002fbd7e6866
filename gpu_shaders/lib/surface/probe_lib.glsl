// A probe: colour and depth of a scene as seen from a point, in six faces of a cube, three in a row.
#ifndef PROBE_LIB_GLSL
#define PROBE_LIB_GLSL

#define PROBE_STEPS 16
#define PROBE_HALVINGS 8
// Each step of a ray through a probe is as much longer than the one before.
#define PROBE_GROWTH 1.5

// Depth in the face of a direction (z) and the place in the atlas, 0 to 1 (xy). Must agree with
// addon/engine/drawing/glass/probes.py.
vec3 probe_place(vec3 direction, float side)
{
  vec3 size = abs(direction);
  int face;
  vec3 forwards, up = vec3(0.0, 0.0, 1.0);
  if (size.x >= size.y && size.x >= size.z) {
    face = direction.x > 0.0 ? 0 : 1;
    forwards = vec3(sign(direction.x), 0.0, 0.0);
  }
  else if (size.y >= size.z) {
    face = direction.y > 0.0 ? 2 : 3;
    forwards = vec3(0.0, sign(direction.y), 0.0);
  }
  else {
    face = direction.z > 0.0 ? 4 : 5;
    forwards = vec3(0.0, 0.0, sign(direction.z));
    up = vec3(0.0, 1.0, 0.0);
  }
  float depth = max(dot(direction, forwards), 1e-12);
  vec2 on_face = vec2(dot(direction, cross(forwards, up)), dot(direction, up)) / depth;
  vec2 texel = clamp((on_face * 0.5 + 0.5) * side, vec2(0.5), vec2(side - 0.5));
  vec2 corner = vec2(face % 3, face / 3) * side;
  return vec3((corner + texel) / (vec2(3.0, 2.0) * side), depth);
}

// Depth along the axis of a face.
float probe_depth(float window_depth, vec2 clip)
{
  return clip.x * clip.y / max(clip.y - window_depth * (clip.y - clip.x), 1e-12);
}

// How far a point, relative to the probe, lies behind what the probe sees there; above 0 behind.
float probe_behind(sampler2D depth_tx, vec3 point, vec4 clip)
{
  vec3 place = probe_place(point, clip.z);
  float window_depth = texelFetch(depth_tx, ivec2(place.xy * vec2(3.0, 2.0) * clip.z), 0).x;
  return (window_depth >= 1.0) ? -1e30 : place.z - probe_depth(window_depth, clip.xy);
}

// The distance along a ray at which it meets what a probe sees; below 0 where it meets nothing.
// `start` relative to the probe; `radius`: length of the first step.
float probe_trace(sampler2D depth_tx, vec3 start, vec3 direction, float radius, vec4 clip)
{
  float before = 0.0, here = 0.0, stride = 0.2 * radius;
  bool was_front = probe_behind(depth_tx, start, clip) <= 0.0;
  for (int i = 0; i < PROBE_STEPS; i++) {
    here = (i + 1 < PROBE_STEPS) ? before + stride : clip.y;
    bool front = probe_behind(depth_tx, start + here * direction, clip) <= 0.0;
    if (was_front && !front) {
      float low = before, high = here;
      for (int k = 0; k < PROBE_HALVINGS; k++) {
        float middle = 0.5 * (low + high);
        if (probe_behind(depth_tx, start + middle * direction, clip) > 0.0) {
          high = middle;
        }
        else {
          low = middle;
        }
      }
      // Else the ray only passes behind an edge.
      if (probe_behind(depth_tx, start + high * direction, clip) < 0.1 * (high + radius)) {
        return high;
      }
    }
    was_front = front;
    before = here;
    stride *= PROBE_GROWTH;
  }
  return -1.0;
}

#endif
