// Blender's Mapping node.
#ifndef VECTOR_LIB_GLSL
#define VECTOR_LIB_GLSL

// Rotation by XYZ Euler angles, in radians.
mat3 euler_matrix(vec3 angles)
{
  vec3 s = sin(angles), c = cos(angles);
  mat3 x = mat3(1.0, 0.0, 0.0, 0.0, c.x, s.x, 0.0, -s.x, c.x);
  mat3 y = mat3(c.y, 0.0, -s.y, 0.0, 1.0, 0.0, s.y, 0.0, c.y);
  mat3 z = mat3(c.z, s.z, 0.0, -s.z, c.z, 0.0, 0.0, 0.0, 1.0);
  return z * y * x;
}

// Division that gives 0 where the divisor is 0, as Blender's nodes do.
vec3 safe_divide(vec3 a, vec3 b)
{
  return mix(a / b, vec3(0.0), equal(b, vec3(0.0)));
}

vec3 safe_normalize(vec3 v)
{
  float size = length(v);
  return (size > 0.0) ? v / size : vec3(0.0);
}

vec3 mapping_point(vec3 v, vec3 location, vec3 rotation, vec3 scale)
{
  return euler_matrix(rotation) * (v * scale) + location;
}

vec3 mapping_texture(vec3 v, vec3 location, vec3 rotation, vec3 scale)
{
  return safe_divide(transpose(euler_matrix(rotation)) * (v - location), scale);
}

vec3 mapping_vector(vec3 v, vec3 rotation, vec3 scale)
{
  return euler_matrix(rotation) * (v * scale);
}

vec3 mapping_normal(vec3 v, vec3 rotation, vec3 scale)
{
  return safe_normalize(euler_matrix(rotation) * safe_divide(v, scale));
}

#endif
