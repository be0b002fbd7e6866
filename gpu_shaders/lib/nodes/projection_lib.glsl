// Where an image is looked up: from a place around it, or from a direction.
#ifndef PROJECTION_LIB_GLSL
#define PROJECTION_LIB_GLSL
#include "lib/nodes/point_lib.glsl"

#define PROJECTION_PI 3.14159265358979

// The angle of a place in the plane; 0 at its origin, of which GLSL says nothing.
float angle_of(float y, float x)
{
  return (x == 0.0 && y == 0.0) ? 0.0 : atan(y, x);
}

// An image wrapped around a tube along z; the place runs from 0 to 1.
vec2 project_tube(vec3 place)
{
  vec3 p = 2.0 * (place - 0.5);
  float size = length(p.xy);
  if (size <= 0.0) {
    return vec2(0.0);
  }
  return 0.5 * vec2(1.0 - atan(p.x, p.y) / PROJECTION_PI, p.z + 1.0);
}

vec2 project_sphere(vec3 place)
{
  vec3 p = 2.0 * (place - 0.5);
  float size = length(p);
  if (size <= 0.0) {
    return vec2(0.0);
  }
  float u = (p.x == 0.0 && p.y == 0.0) ? 0.0 : 0.5 * (1.0 - atan(p.x, p.y) / PROJECTION_PI);
  return vec2(u, 1.0 - acos(clamp(p.z / size, -1.0, 1.0)) / PROJECTION_PI);
}

vec2 project_equirectangular(vec3 direction)
{
  if (direction == vec3(0.0)) {
    return vec2(0.0);
  }
  float longitude = angle_of(direction.y, direction.x);
  float latitude = angle_of(direction.z, length(direction.xy));
  return vec2(0.5 - longitude / (2.0 * PROJECTION_PI), latitude / PROJECTION_PI + 0.5);
}

// Of a sky, as Cycles looks it up: the height alone tells the latitude, whatever the vector's length.
vec2 project_sky(vec3 direction)
{
  float longitude = angle_of(direction.y, direction.x);
  float latitude = asin(clamp(direction.z, -1.0, 1.0));
  // Not past the poles: half a texel of the image.
  float v = clamp(latitude / PROJECTION_PI + 0.5, 0.5 / 1024.0, 1.0 - 0.5 / 1024.0);
  return vec2(0.5 - longitude / (2.0 * PROJECTION_PI), v);
}

// Of a lamp's intensities: around, from -y, and up from straight below.
vec2 project_photometric(vec3 direction)
{
  vec3 d = direction / max(length(direction), 1e-12);
  float around = angle_of(d.x, d.y) + PROJECTION_PI;
  return vec2(around / (2.0 * PROJECTION_PI), acos(clamp(-d.z, -1.0, 1.0)) / PROJECTION_PI);
}

// Of a photograph of a mirror ball, seen along +y.
vec2 project_mirror_ball(vec3 direction)
{
  vec3 d = direction / max(length(direction), 1e-12) - vec3(0.0, 1.0, 0.0);
  float size = 2.0 * sqrt(max(-0.5 * d.y, 0.0));
  d = (size > 0.0) ? d / size : d;
  return 0.5 * (d.xz + 1.0);
}

// The surface's normal in object space, by which the sides of a box are chosen.
vec3 box_normal()
{
  return unit_or(normal_to_object(point_object(), point_normal()), vec3(0.0, 0.0, 1.0));
}

// Shares of the three pairs of sides. `blend`: how softly they go over into each other.
vec3 box_weights(vec3 normal, float blend)
{
  vec3 n = abs(normal);
  n /= n.x + n.y + n.z;
  float limit = 0.5 * (1.0 + blend);
  float xy = n.x + n.y, yz = n.y + n.z, xz = n.x + n.z;
  if (n.x > limit * xy && n.x > limit * xz) {
    return vec3(1.0, 0.0, 0.0);
  }
  if (n.y > limit * xy && n.y > limit * yz) {
    return vec3(0.0, 1.0, 0.0);
  }
  if (n.z > limit * xz && n.z > limit * yz) {
    return vec3(0.0, 0.0, 1.0);
  }
  if (blend <= 0.0) {
    return vec3(1.0, 0.0, 0.0);
  }
  float low = 0.5 * (1.0 - blend);
  if (n.z < (1.0 - limit) * xy) {
    float x = clamp((n.x / xy - low) / blend, 0.0, 1.0);
    return vec3(x, 1.0 - x, 0.0);
  }
  if (n.x < (1.0 - limit) * yz) {
    float y = clamp((n.y / yz - low) / blend, 0.0, 1.0);
    return vec3(0.0, y, 1.0 - y);
  }
  if (n.y < (1.0 - limit) * xz) {
    float x = clamp((n.x / xz - low) / blend, 0.0, 1.0);
    return vec3(x, 0.0, 1.0 - x);
  }
  return ((2.0 - limit) * n + (limit - 1.0)) / (2.0 * limit - 1.0);
}

vec2 box_uv(vec3 place, vec3 normal, int axis)
{
  if (axis == 0) {
    return vec2((normal.x < 0.0) ? 1.0 - place.y : place.y, place.z);
  }
  if (axis == 1) {
    return vec2((normal.y > 0.0) ? 1.0 - place.x : place.x, place.z);
  }
  return vec2((normal.z > 0.0) ? 1.0 - place.y : place.y, place.x);
}

#endif
