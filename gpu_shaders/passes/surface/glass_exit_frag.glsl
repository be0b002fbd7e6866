// The back of glass, as a lens sample sees it.
// Inputs: varyings of surface_vert; view_buf.
// Outputs: normal in world space (xyz) and window depth (w), of the farthest face.
#include "lib/nodes/point_lib.glsl"

void main()
{
  vec3 view = point_view();
  vec3 geometric = point_geometric_normal(view);
#ifdef HAS_NORMAL
  // Fronts are no backs.
  if (dot(world_normal, geometric) > 0.0) {
    discard;
  }
#else
  discard;
#endif
  out_exit = vec4(normalize(point_smooth_normal(geometric)), gl_FragCoord.z);
}
