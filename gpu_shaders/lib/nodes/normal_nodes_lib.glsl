// Nodes that bend normals, and that turn vectors between spaces.
// Bump: Mikkelsen, Bump mapping unparametrized surfaces on the GPU, 2010.
#ifndef NORMAL_NODES_LIB_GLSL
#define NORMAL_NODES_LIB_GLSL
#include "lib/nodes/point_lib.glsl"

#define SPACE_WORLD 0
#define SPACE_OBJECT 1
#define SPACE_CAMERA 2

// A normal bent by the slope of a height: `across` and `up` are the changes of the place over a pixel,
// `slopes` those of the height.
vec3 bend_normal(
    vec3 normal, vec3 across, vec3 up, vec2 slopes, float strength, float distance)
{
  vec3 rx = cross(up, normal), ry = cross(normal, across);
  float det = dot(across, rx);
  vec3 slope = slopes.x * rx + slopes.y * ry;
  vec3 bent = abs(det) * normal - distance * sign(det) * slope;
  return unit_or(mix(normal, unit_or(bent, normal), max(strength, 0.0)), normal);
}

// `height` must be read in uniform control flow.
vec3 bump_normal(float height, float strength, float distance, vec3 normal)
{
  vec3 across = dFdx(world_position), up = dFdy(world_position);
  vec2 slopes = vec2(dFdx(height), dFdy(height));
  return bend_normal(normal, across, up, slopes, strength, distance);
}

// The same with a height in units of object space.
vec3 bump_normal_of_object(float height, vec3 normal)
{
  mat4 object = point_object();
  mat3 to_object = inverse(mat3(object));
  vec3 own = unit_or(normal_to_object(object, normal), vec3(0.0));
  vec3 across = to_object * dFdx(world_position), up = to_object * dFdy(world_position);
  vec2 slopes = vec2(dFdx(height), dFdy(height));
  vec3 bent = bend_normal(own, across, up, slopes, 1.0, 1.0);
  return unit_or(normal_to_world(object, bent), normal);
}

// A normal map in tangent space. `tangent`: object space, w: handedness; `smooth_normal`: object space.
vec3 tangent_space_normal(vec3 color, float strength, vec4 tangent, vec3 smooth_normal)
{
  vec3 map = 2.0 * color - 1.0;
  map = vec3(map.xy * strength, mix(1.0, map.z, clamp(strength, 0.0, 1.0)));
  vec3 bitangent = tangent.w * cross(smooth_normal, tangent.xyz);
  vec3 bent = map.x * tangent.xyz + map.y * bitangent + map.z * smooth_normal;
  bent = normal_to_world(point_object(), unit_or(bent, vec3(0.0)));
  bent = (point_backfacing() > 0.5) ? -bent : bent;
  return unit_or(bent, point_normal());
}

// A normal map in object or world space.
vec3 spatial_normal(vec3 color, float strength, bool of_object)
{
  vec3 map = 2.0 * color - 1.0;
  map = of_object ? normal_to_world(point_object(), map) : map;
  map = unit_or(map, vec3(0.0));
  map = (point_backfacing() > 0.5) ? -map : map;
  vec3 normal = point_normal();
  return unit_or(mix(normal, map, max(strength, 0.0)), normal);
}

vec3 rotate_about(vec3 v, vec3 center, vec3 axis, float angle)
{
  float size = length(axis);
  if (size == 0.0) {
    return v;
  }
  vec3 a = axis / size, p = v - center;
  float c = cos(angle), s = sin(angle);
  return p * c + cross(a, p) * s + a * dot(a, p) * (1.0 - c) + center;
}

vec3 place_to_world(vec3 v, int space)
{
  if (space == SPACE_OBJECT) {
    return (point_object() * vec4(v, 1.0)).xyz;
  }
  if (space == SPACE_CAMERA) {
    return (inverse(POINT_CAMERA) * vec4(v * vec3(1.0, 1.0, -1.0), 1.0)).xyz;
  }
  return v;
}

vec3 place_from_world(vec3 v, int space)
{
  if (space == SPACE_OBJECT) {
    return (inverse(point_object()) * vec4(v, 1.0)).xyz;
  }
  return (space == SPACE_CAMERA) ? place_in_camera(v) : v;
}

vec3 direction_to_world(vec3 v, int space)
{
  if (space == SPACE_OBJECT) {
    return mat3(point_object()) * v;
  }
  if (space == SPACE_CAMERA) {
    return transpose(mat3(POINT_CAMERA)) * (v * vec3(1.0, 1.0, -1.0));
  }
  return v;
}

vec3 direction_from_world(vec3 v, int space)
{
  if (space == SPACE_OBJECT) {
    return inverse(mat3(point_object())) * v;
  }
  if (space == SPACE_CAMERA) {
    return mat3(POINT_CAMERA) * v * vec3(1.0, 1.0, -1.0);
  }
  return v;
}

vec3 normal_between(vec3 v, int from, int to)
{
  vec3 world = direction_to_world(v, from);
  if (from == SPACE_OBJECT) {
    world = normal_to_world(point_object(), v);
  }
  vec3 turned = direction_from_world(world, to);
  if (to == SPACE_OBJECT) {
    turned = normal_to_object(point_object(), world);
  }
  return unit_or(turned, vec3(0.0));
}

#endif
