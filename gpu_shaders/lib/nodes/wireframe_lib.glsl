// The edges of triangles as lines. `place`: two barycentric coordinates, which must be read in uniform
// control flow.
#ifndef WIREFRAME_LIB_GLSL
#define WIREFRAME_LIB_GLSL

// Lines as wide as `size` in world space, seen from either triangle.
float wireframe_world(vec2 place, float size)
{
  vec3 b = vec3(place, 1.0 - place.x - place.y);
  vec3 across = dFdx(world_position), up = dFdy(world_position);
  vec3 bx = dFdx(b), by = dFdy(b);
  float xx = dot(across, across), yy = dot(up, up), xy = dot(across, up);
  float det = max(xx * yy - xy * xy, 1e-30);
  // Slopes of the coordinates in the triangle's plane.
  vec3 slope2 = (bx * bx * yy - 2.0 * bx * by * xy + by * by * xx) / det;
  vec3 distance = b * inversesqrt(max(slope2, vec3(1e-30)));
  return (min(distance.x, min(distance.y, distance.z)) < 0.5 * abs(size)) ? 1.0 : 0.0;
}

// Lines as wide as a number of pixels.
float wireframe_pixel(vec2 place, float size)
{
  vec3 b = vec3(place, 1.0 - place.x - place.y);
  vec3 bx = dFdx(b), by = dFdy(b);
  vec3 distance = b * inversesqrt(max(bx * bx + by * by, vec3(1e-30)));
  return (min(distance.x, min(distance.y, distance.z)) < 0.5 * abs(size)) ? 1.0 : 0.0;
}

#endif
