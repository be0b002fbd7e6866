// Looking up a world's image from the nodes of the world.
#ifndef ENVIRONMENT_SAMPLE_LIB_GLSL
#define ENVIRONMENT_SAMPLE_LIB_GLSL
#include "lib/surface/environment_lib.glsl"
#include "lib/surface/texture_lib.glsl"

// The direction for which the world is computed.
vec3 world_direction;

// An equirectangular image, turned by the rows of a rotation.
vec4 environment_sample(sampler2D tx, vec3 x, vec3 y, vec3 z)
{
  vec3 local = vec3(dot(x, world_direction), dot(y, world_direction), dot(z, world_direction));
  return image_linear(tx, direction_to_equirect(local), EXTENSION_REPEAT);
}

#endif
