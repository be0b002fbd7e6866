// The thin lens in camera space (methods 1). Lengths in metres.
#ifndef LENS_LIB_GLSL
#define LENS_LIB_GLSL

// Where a point of camera space appears, in the pinhole's camera space, from the place `lens_xy`
// on the lens: displaced by -R(d) v, nothing at the focus distance. An affine shear along z.
vec3 lens_displace(vec3 eye, vec2 lens_xy, float focus_distance)
{
  return vec3(eye.xy - lens_xy * (focus_distance + eye.z) / focus_distance, eye.z);
}

// Signed radius of the circle of confusion in pixels, negative in front of the focus plane.
// `lens` as in ViewParams; depth along the axis, m.
float coc_radius_px(float depth, vec4 lens)
{
  float defocus = lens.z * (depth - lens.x) / lens.x;
  return (lens.y > 0.5) ? defocus : defocus / depth;
}

// The same at another focus, given as 1 / focus distance, 1/m.
float coc_radius_at(float depth, float focus, vec4 lens)
{
  return lens.z * ((lens.y > 0.5) ? depth * focus - 1.0 : focus - 1.0 / depth);
}

// Focus matte of a point: share of its light inside the largest circle of confusion that counts as
// sharp.
float focus_share(float coc_px, float sharp_px)
{
  float ratio = sharp_px / max(abs(coc_px), sharp_px);
  return ratio * ratio;
}

#endif
