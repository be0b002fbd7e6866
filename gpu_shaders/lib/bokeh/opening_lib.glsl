// The lens' opening as a stack of layers of its light density, each blurred twice as much as the one
// before (addon/lens_bokeh/look/opening.py).
#ifndef OPENING_LIB_GLSL
#define OPENING_LIB_GLSL

// Blur of the first layer in units of the opening's radius: the side of a box of the same variance.
#define OPENING_LEAST_BLUR (1.0 / 128.0)

// How far from the centre a layer reaches.
float opening_extent(float layer)
{
  return 1.0 + OPENING_LEAST_BLUR * exp2(layer) * 0.70710678;
}

vec3 opening_layer(sampler2DArray tx, vec2 place, float layer)
{
  vec2 uv = place / opening_extent(layer) * 0.5 + 0.5;
  if (any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) {
    return vec3(0.0);
  }
  return texture(tx, vec3(uv, layer)).rgb;
}

// For a blur as OPENING_LEAST_BLUR, of `layers` layers: the lower of two, and the share of the upper.
vec2 opening_layers(float layers, float blur)
{
  float top = layers - 1.0;
  float level = clamp(log2(max(blur, 1e-6) / OPENING_LEAST_BLUR), 0.0, top);
  float lower = min(floor(level), max(top - 1.0, 0.0));
  // Variances add up: the mixture of two layers has the variance of the blur.
  return vec2(lower, (exp2(2.0 * (level - lower)) - 1.0) / 3.0);
}

// Share of the light per unit of area at a place of the opening.
vec3 opening_density(sampler2DArray tx, vec2 place, float blur)
{
  vec2 layers = opening_layers(float(textureSize(tx, 0).z), blur);
  vec3 density = opening_layer(tx, place, layers.x);
  return (layers.y > 0.0) ? mix(density, opening_layer(tx, place, layers.x + 1.0), layers.y) :
                            density;
}

#endif
