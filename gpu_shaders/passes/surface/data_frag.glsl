// What a pinhole at the lens' centre sees in the middle of a pixel: geometry instead of colour.
// Surfaces that are less opaque than the threshold are left out, by a hard decision.
// Inputs: varyings of surface_vert; view_buf; data_buf; surface_closure() of transparent surfaces;
// LENS_BLUR: real_lens_buf, blur_tx (what the lens adds to the circle of confusion).
// Outputs: normal in world space, towards the camera (xyz) and depth along the axis, m (w); position
// in world space (xyz) and signed circle of confusion, px (w); movement since the previous frame
// (xy) and to the next (zw), px. HAS_DETAIL: level of detail (x), share of the lens samples that copy
// a drawing of it (y), whether there is anything (z); from the instance table.
// Source: methods 1; signs and conventions of Cycles' passes.
#include "lib/lens_lib.glsl"
#ifdef HAS_DETAIL
#include "lib/surface/instance_lib.glsl"
#endif
#ifdef LENS_BLUR
#include "lib/real_lens_lib.glsl"
#endif

// Depth where nothing is, as in Blender.
#define EMPTY_DEPTH 1e10

vec2 clip_to_pixels(vec4 clip)
{
  return clip.xy / clip.w * data_buf.raster.xy;
}

void main()
{
#ifdef HOLDOUT
  out_normal_depth = vec4(0.0, 0.0, 0.0, EMPTY_DEPTH);
  out_position_coc = vec4(0.0, 0.0, 0.0, coc_radius_px(EMPTY_DEPTH, view_buf.lens));
  out_vector = vec4(0.0);
#ifdef HAS_DETAIL
  out_detail = vec4(0.0);
#endif
#else
#ifdef TRANSPARENT
  if (1.0 - closure_through(surface_closure()) < data_buf.raster.z) {
    discard;
  }
#endif
  vec3 eye = (view_buf.view * vec4(world_position, 1.0)).xyz;
  vec3 towards_camera = view_buf.lens.y > 0.5 ? vec3(0.0, 0.0, 1.0) : -eye;
  towards_camera = mat3(view_buf.view_inverse) * towards_camera;
  // The side that is seen is a property of the triangle, not of its interpolated normal.
  vec3 geometric = cross(dFdx(world_position), dFdy(world_position));
  geometric = dot(geometric, towards_camera) < 0.0 ? -geometric : geometric;
#ifdef HAS_NORMAL
  vec3 normal = dot(world_normal, geometric) < 0.0 ? -world_normal : world_normal;
#else
  vec3 normal = geometric;
#endif
  float size = length(normal);
  out_normal_depth = vec4(size > 0.0 ? normal / size : vec3(0.0), -eye.z);
  float coc = coc_radius_px(-eye.z, view_buf.lens);
#ifdef LENS_BLUR
  coc += real_lens_blur(blur_tx, eye, real_lens_buf);
#endif
  out_position_coc = vec4(world_position, coc);
#ifdef HAS_VECTOR
  vec2 now = clip_to_pixels(view_buf.projection * vec4(eye, 1.0));
  out_vector = vec4(clip_to_pixels(previous_clip) - now, now - clip_to_pixels(next_clip));
#else
  out_vector = vec4(0.0);
#endif
#ifdef HAS_DETAIL
  out_detail = vec4(texelFetch(instances_tx, instance_texel(instance_row, 3), 0).yz, 1.0, 0.0);
#endif
#endif
}
