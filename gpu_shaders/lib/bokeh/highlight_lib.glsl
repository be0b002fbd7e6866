// The highlight threshold: which light the lens samples keep and which is splatted as bokeh
// (methods 9, 10); the same as addon/sampling/highlights.py.
#ifndef HIGHLIGHT_LIB_GLSL
#define HIGHLIGHT_LIB_GLSL

// The share grows from 0 to 1 while the circle of confusion grows by this factor.
#define HIGHLIGHT_TRANSITION 1.5

// Share of the light above the threshold that is splatted. `coc_px`: signed radius of the circle of
// confusion; `least_px`: radius from which on light is splatted.
float highlight_share(float coc_px, float least_px)
{
  return smoothstep(least_px, HIGHLIGHT_TRANSITION * least_px, abs(coc_px));
}

// Share of the radiance that lies below the threshold, by its largest channel.
float highlight_below(vec3 radiance, float threshold)
{
  float peak = max(max(radiance.r, max(radiance.g, radiance.b)), 1e-30);
  return min(threshold / peak, 1.0);
}

// Share of a highlight that the lens samples keep: nothing from twice the threshold on.
float highlight_kept(vec3 radiance, float threshold)
{
  float below = highlight_below(radiance, threshold);
  return below * clamp(2.0 - 1.0 / below, 0.0, 1.0);
}

// Light that is splatted, of the same hue as the radiance; what lies above the threshold times the
// gain.
vec3 highlight_light(vec3 radiance, float threshold, float gain)
{
  float below = highlight_below(radiance, threshold);
  return radiance * (below - highlight_kept(radiance, threshold) + gain * (1.0 - below));
}

// The same, where the part `unsplit` of the radiance is never splatted.
vec3 highlight_light(vec3 radiance, vec3 unsplit, float threshold, float gain)
{
  return highlight_light(radiance - unsplit, threshold, gain);
}

// Radiance without the splatted part, to full precision however bright it is.
vec3 highlight_base(vec3 radiance, float share, float threshold)
{
  return radiance * mix(1.0, highlight_kept(radiance, threshold), share);
}

// The same, where the part `unsplit` of the radiance is never splatted.
vec3 highlight_base(vec3 radiance, vec3 unsplit, float share, float threshold)
{
  return unsplit + highlight_base(radiance - unsplit, share, threshold);
}

#endif
