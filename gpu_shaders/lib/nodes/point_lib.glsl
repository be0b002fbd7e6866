// The point of a surface at which a tree of nodes is evaluated: place, normals, direction of view.
// Reads globals of the surface shaders: world_position, world_normal where the mesh has normals,
// instance_row; DEFERRED: surface_geometric; SEEN: view_buf and lens_sample (OF_LAYER: eye), else visibility_buf.
#ifndef POINT_LIB_GLSL
#define POINT_LIB_GLSL
#include "lib/surface/instance_lib.glsl"

#ifdef SEEN
#define POINT_CAMERA view_buf.view
#define POINT_PROJECTION view_buf.projection
#else
#define POINT_CAMERA visibility_buf.view
#define POINT_PROJECTION visibility_buf.projection
#endif

// The normal that displacement has bent; 0 without.
vec3 point_bent = vec3(0.0);

// Towards the eye: the place on the lens that the sample looks from.
vec3 point_view()
{
#ifdef SEEN
#ifdef OF_LAYER
  vec2 from = eye;
#else
  vec2 from = lens_sample.xy;
#endif
  vec3 view = (view_buf.lens.y > 0.5) ? vec3(from / view_buf.lens.x, 1.0) : vec3(from, 0.0);
  if (view_buf.lens.y > 0.5) {
    return normalize(mat3(view_buf.view_inverse) * view);
  }
  return normalize((view_buf.view_inverse * vec4(view, 1.0)).xyz - world_position);
#else
  mat3 turned = transpose(mat3(visibility_buf.view));
  if (visibility_buf.lens.y > 0.5) {
    return normalize(turned * vec3(0.0, 0.0, 1.0));
  }
  return normalize(-turned * visibility_buf.view[3].xyz - world_position);
#endif
}

// Of the triangle, on the side that is seen; of any length.
vec3 point_geometric_normal(vec3 view)
{
#ifdef DEFERRED
  vec3 geometric = surface_geometric;
#else
  vec3 geometric = cross(dFdx(world_position), dFdy(world_position));
#endif
  return (dot(geometric, view) < 0.0) ? -geometric : geometric;
}

// The interpolated or bent normal on the side that is seen; of any length.
vec3 point_smooth_normal(vec3 geometric)
{
  if (dot(point_bent, point_bent) > 0.0) {
    return point_bent;
  }
#ifdef HAS_NORMAL
  return (dot(world_normal, geometric) < 0.0) ? -world_normal : world_normal;
#else
  return geometric;
#endif
}

vec3 point_normal()
{
  vec3 view = point_view();
  vec3 normal = point_smooth_normal(point_geometric_normal(view));
  float size = length(normal);
  return (size > 0.0) ? normal / size : view;
}

vec3 point_true_normal()
{
  vec3 geometric = point_geometric_normal(point_view());
  float size = length(geometric);
  return (size > 0.0) ? geometric / size : point_view();
}

// 1 where the back of a triangle is seen. The side is told by the mesh's normals.
float point_backfacing()
{
#ifdef HAS_NORMAL
  return (dot(world_normal, point_geometric_normal(point_view())) < 0.0) ? 1.0 : 0.0;
#else
  return 0.0;
#endif
}

mat4 point_object()
{
  return instance_world(instances_tx, instance_row);
}

// Normals turn with the cofactor matrix: any scale is right, and mirrored objects, too.
vec3 normal_to_world(mat4 object, vec3 normal)
{
  vec3 x = object[0].xyz, y = object[1].xyz, z = object[2].xyz;
  mat3 cofactor = mat3(cross(y, z), cross(z, x), cross(x, y));
  return cofactor * normal * (dot(x, cross(y, z)) < 0.0 ? -1.0 : 1.0);
}

vec3 normal_to_object(mat4 object, vec3 normal)
{
  return transpose(mat3(object)) * normal;
}

vec3 unit_or(vec3 v, vec3 otherwise)
{
  float size = length(v);
  return (size > 0.0) ? v / size : otherwise;
}

// Camera space as Blender's nodes have it: looking along +z.
vec3 place_in_camera(vec3 place)
{
  return (POINT_CAMERA * vec4(place, 1.0)).xyz * vec3(1.0, 1.0, -1.0);
}

// Place in the picture, 0 to 1.
vec3 point_window()
{
  vec4 clip = POINT_PROJECTION * (POINT_CAMERA * vec4(world_position, 1.0));
  return vec3(clip.xy / clip.w * 0.5 + 0.5, 0.0);
}

#endif
