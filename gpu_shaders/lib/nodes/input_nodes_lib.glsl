// Nodes that tell how a surface lies to the eye: Fresnel, Layer Weight, Camera Data, tangents.
#ifndef INPUT_NODES_LIB_GLSL
#define INPUT_NODES_LIB_GLSL
#include "lib/nodes/point_lib.glsl"
#include "lib/surface/fresnel_lib.glsl"

float node_fresnel(float ior, vec3 normal)
{
  float eta = max(ior, 1e-5);
  eta = (point_backfacing() > 0.5) ? 1.0 / eta : eta;
  return fresnel_dielectric(dot(point_view(), normal), eta);
}

float layer_fresnel(float blend, vec3 normal)
{
  float eta = max(1.0 - blend, 1e-5);
  eta = (point_backfacing() > 0.5) ? eta : 1.0 / eta;
  return fresnel_dielectric(dot(point_view(), normal), eta);
}

float layer_facing(float blend, vec3 normal)
{
  float facing = abs(dot(point_view(), normal));
  if (blend != 0.5) {
    float t = clamp(blend, 0.0, 1.0 - 1e-5);
    facing = pow(facing, (t < 0.5) ? 2.0 * t : 0.5 / (1.0 - t));
  }
  return 1.0 - facing;
}

// A tangent that runs around an axis (0, 1, 2) of the texture space.
vec3 tangent_around(vec3 generated, int axis)
{
  vec3 p = generated - 0.5;
  vec3 around = vec3(-p.y, p.x, 0.0);
  if (axis == 0) {
    around = vec3(0.0, -p.z, p.y);
  }
  else if (axis == 1) {
    around = vec3(-p.z, 0.0, p.x);
  }
  return around;
}

vec3 tangent_of(vec3 around)
{
  vec3 normal = point_normal();
  vec3 turned = normal_to_world(point_object(), around);
  return cross(normal, unit_or(cross(turned, normal), vec3(0.0)));
}

#endif
