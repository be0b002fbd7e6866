// The thin lens in camera space (methods 1). Lengths in metres.
#ifndef LENS_LIB_GLSL
#define LENS_LIB_GLSL

// Where a point of camera space appears, in the pinhole's camera space, from the place `lens_xy`
// on the lens: displaced by -R(d) v, nothing at the focus distance. An affine shear along z.
vec3 lens_displace(vec3 eye, vec2 lens_xy, float focus_distance)
{
  return vec3(eye.xy - lens_xy * (focus_distance + eye.z) / focus_distance, eye.z);
}

#endif
