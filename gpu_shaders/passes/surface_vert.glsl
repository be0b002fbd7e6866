// Draws instanced meshes as one lens sample sees them.
// Inputs: mesh attributes; instances_tx (instance table); view_buf; lens_sample (xy: place on the
// lens, m; zw: sub-pixel jitter in clip units); instance_base.
// Outputs: world position and normal, instance row, the attributes that the surface reads.
// Source: methods 1 (HA90, JKL13 section 3).
#include "lib/lens_lib.glsl"
#include "lib/instance_lib.glsl"

void main()
{
  int instance = instance_base + gl_InstanceID;
  mat4 world = instance_world(instances_tx, instance);
  vec4 position = world * vec4(pos, 1.0);
  vec3 eye = lens_displace((view_buf.view * position).xyz, lens_sample.xy, view_buf.lens.x);
  gl_Position = view_buf.projection * vec4(eye, 1.0);
  gl_Position.xy += lens_sample.zw * gl_Position.w;
  world_position = position.xyz;
  instance_row = instance;
#ifdef HAS_NORMAL
  // The cofactor matrix carries normals through any scale; its sign follows the determinant.
  vec3 x = world[0].xyz, y = world[1].xyz, z = world[2].xyz;
  mat3 cofactor = mat3(cross(y, z), cross(z, x), cross(x, y));
  float handedness = dot(x, cross(y, z)) < 0.0 ? -1.0 : 1.0;
  world_normal = handedness * (cofactor * ATTRIBUTE_NORMAL);
#endif
  forward_attributes();
}
