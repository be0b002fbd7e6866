// A lit closure: radiance towards the eye, and transmittance.
#ifndef CLOSURE_LIB_GLSL
#define CLOSURE_LIB_GLSL
#include "lib/finite_lib.glsl"

struct Closure {
  vec3 radiance;       // scene linear, towards the eye
  vec3 transmittance;  // share of the light from straight behind the surface
  float holdout;       // share of the pixel that becomes transparent in the picture
  vec3 unsplit;        // part of the radiance that is never splatted (lamps without highlights)
  vec3 shift;          // to be added to what is left once highlights are split off: shadows of this
                       // sample instead of the steady ones
};

Closure closure_none()
{
  return Closure(vec3(0.0), vec3(0.0), 0.0, vec3(0.0), vec3(0.0));
}

Closure closure_emission(vec3 color, float strength)
{
  // Negative light stays negative, as in Cycles.
  return Closure(finite_light(color * strength), vec3(0.0), 0.0, vec3(0.0), vec3(0.0));
}

Closure closure_transparent(vec3 color)
{
  return Closure(vec3(0.0), max(finite_light(color), vec3(0.0)), 0.0, vec3(0.0), vec3(0.0));
}

Closure closure_holdout()
{
  return Closure(vec3(0.0), vec3(0.0), 1.0, vec3(0.0), vec3(0.0));
}

Closure closure_mix(Closure a, Closure b, float factor)
{
  float t = clamp(number_or_zero(factor), 0.0, 1.0);
  return Closure(mix(a.radiance, b.radiance, t),
                 mix(a.transmittance, b.transmittance, t),
                 mix(a.holdout, b.holdout, t),
                 mix(a.unsplit, b.unsplit, t),
                 mix(a.shift, b.shift, t));
}

Closure closure_add(Closure a, Closure b)
{
  return Closure(a.radiance + b.radiance,
                 a.transmittance + b.transmittance,
                 a.holdout + b.holdout,
                 a.unsplit + b.unsplit,
                 a.shift + b.shift);
}

// The light and the transmittance of a surface, made less by what lies on top.
Closure closure_scaled(Closure a, float share)
{
  Closure scaled = closure_mix(closure_none(), a, share);
  scaled.holdout = a.holdout;
  return scaled;
}

// A surface of opacity `alpha`.
Closure closure_cover(Closure a, float alpha)
{
  float t = clamp(number_or_zero(alpha), 0.0, 1.0);
  return Closure(
      a.radiance * t, mix(vec3(1.0), a.transmittance, t), a.holdout * t, a.unsplit * t, a.shift * t);
}

// Probability that a lens sample sees through the surface; what it sees is filtered by the
// transmittance over it.
float closure_through(Closure a)
{
  return clamp(dot(a.transmittance, vec3(1.0 / 3.0)), 0.0, 1.0);
}

#endif
