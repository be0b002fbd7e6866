// How far a ray runs through a volume whose mesh is taken as the box around it.
#ifndef FOG_LIB_GLSL
#define FOG_LIB_GLSL
#include "lib/nodes/point_lib.glsl"

// Length within the box in world space, m; told once for each ray: at the face where it comes out of
// the box if the eye is inside, else where it goes in. `lowest`, `highest`: corners in object space.
float fog_thickness(vec3 place, vec3 lowest, vec3 highest)
{
  mat3 to_object = inverse(mat3(point_object()));
  vec3 along = to_object * -point_view();
  along += vec3(lessThan(abs(along), vec3(1e-9))) * 1e-9;
  vec3 a = (lowest - place) / along, b = (highest - place) / along;
  vec3 near = min(a, b), far = max(a, b);
  // Where the ray goes in and comes out, from the face that is drawn.
  float start = max(near.x, max(near.y, near.z)), end = min(far.x, min(far.y, far.z));
  float to_eye = length(place_in_camera(world_position));
  bool inside = -start > to_eye && POINT_PROJECTION[3][3] == 0.0;
  if (point_backfacing() > 0.5) {
    // Nothing is seen before the camera's near plane, fog neither.
    float near_plane = POINT_PROJECTION[3][2] / (POINT_PROJECTION[2][2] - 1.0);
    float seen = 1.0 - near_plane / max(place_in_camera(world_position).z, near_plane);
    return inside ? to_eye * seen + max(end, 0.0) : 0.0;
  }
  return max(end - max(start, 0.0), 0.0);
}

#endif
