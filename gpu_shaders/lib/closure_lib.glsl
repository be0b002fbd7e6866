// A closure that has met its light: what it sends to the eye, and what it lets through.
#ifndef CLOSURE_LIB_GLSL
#define CLOSURE_LIB_GLSL

struct Closure {
  vec3 radiance;       // scene linear, towards the eye
  vec3 transmittance;  // share of what is straight behind the surface
};

Closure closure_none()
{
  return Closure(vec3(0.0), vec3(0.0));
}

Closure closure_emission(vec3 color, float strength)
{
  return Closure(color * strength, vec3(0.0));
}

#endif
