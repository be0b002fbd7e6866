// Draws instanced meshes as one lens sample sees them.
// Inputs: mesh attributes; instances_tx (instance table); view_buf; lens_sample (xy: place on the
// lens, m; zw: sub-pixel jitter in clip units); instance_base.
// CHROMATIC: chromatic_buf, field_tx (field table) and dispersion (x: relative change of the focal
// length, y: lateral strength of the sample's wavelength).
// REAL_LENS: real_lens_buf, moves_tx and lens_slot (the sample's place in the tables).
// HAS_VECTOR: data_buf and the instance tables of the neighbouring frames, previous_tx and next_tx;
// HAS_DEFORMATION: the mesh's positions there.
// Outputs: world position and normal, instance row, the attributes that the surface reads; clip
// positions in the neighbouring frames.
// Source: methods 1 (HA90, JKL13 section 3) and 8.
#include "lib/lens_lib.glsl"
#include "lib/surface/instance_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif
#ifdef REAL_LENS
#include "lib/real_lens_lib.glsl"
#endif

void main()
{
  int instance = instance_base + gl_InstanceID;
  mat4 world = instance_world(instances_tx, instance);
  vec4 position = world * vec4(pos, 1.0);
#ifdef CHROMATIC
  vec3 eye = chromatic_displace(
      field_tx, (view_buf.view * position).xyz, lens_sample.xy, dispersion, chromatic_buf);
#else
  vec3 eye = lens_displace((view_buf.view * position).xyz, lens_sample.xy, view_buf.lens.x);
#endif
#ifdef REAL_LENS
  eye.xy += real_lens_shift(moves_tx, (view_buf.view * position).xyz, lens_slot, real_lens_buf);
#endif
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
#ifdef HAS_VECTOR
#ifdef HAS_DEFORMATION
  vec3 before = pos_previous, after = pos_next;
#else
  vec3 before = pos, after = pos;
#endif
  previous_clip = data_buf.previous * (instance_world(previous_tx, instance) * vec4(before, 1.0));
  next_clip = data_buf.next * (instance_world(next_tx, instance) * vec4(after, 1.0));
#endif
  forward_attributes();
}
