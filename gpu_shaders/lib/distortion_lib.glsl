// Distortion of the picture: where a pixel lies in the raster without distortion, and its colour there.
// Source: division model (one term: Fitzgibbon, CVPR 2001); cubic convolution, Keys 1981.
#ifndef DISTORTION_LIB_GLSL
#define DISTORTION_LIB_GLSL

// Least blur that is applied, px: less changes the variance of a pixel's filter by a hundredth.
#define LEAST_SPREAD 0.04

struct Distorted {
  vec2 place;   // in the raster, px
  vec2 along;   // away from the axis, length: the standard deviation of the blur there, px
  vec2 across;  // across that
};

// `pixel`: place in the picture, px. `to_field`, `from_field`: scale and offset from the picture to the
// field, and from the field to the raster. `terms`: K1 to K4. `model`: square of the radius where it
// ends, pixels of the raster along one of the picture, standard deviation of the pixel filter, px.
Distorted distorted_place(vec2 pixel, vec4 to_field, vec4 from_field, vec4 terms, vec3 model)
{
  vec2 field = pixel * to_field.xy + to_field.zw;
  float square = dot(field, field);
  float s = min(square, model.x);
  float across = 1.0 / (1.0 + s * (terms.x + s * (terms.y + s * (terms.z + s * terms.w))));
  float slope = 1.0 - s * (terms.x + s * (3.0 * terms.y + s * (5.0 * terms.z + s * 7.0 * terms.w)));
  float along = (square < model.x) ? across * across * slope : across;
  vec2 away = field * from_field.xy;
  float far = length(away);
  away = (far > 0.0) ? away / far : vec2(1.0, 0.0);
  vec2 growth = model.y * vec2(along, across);
  // This blur and the filter of a raster's pixel together make the filter of a picture's pixel.
  vec2 spread = model.z * sqrt(max(growth * growth - 1.0, 0.0));
  Distorted found;
  found.place = field * across * from_field.xy + from_field.zw;
  found.along = away * spread.x;
  found.across = vec2(-away.y, away.x) * spread.y;
  return found;
}

// Weights of four neighbours; `t`: place between the middle two.
vec4 cubic_weights(float t)
{
  float s = 1.0 - t;
  return vec4(-0.5 * t * s * s,
              1.0 + t * t * (1.5 * t - 2.5),
              1.0 + s * s * (1.5 * s - 2.5),
              -0.5 * s * t * t);
}

// Cubic interpolation, clamped to the range of the neighbours: it would ring beside bright pixels.
vec4 cubic_sample(sampler2D tx, vec2 place)
{
  ivec2 last = textureSize(tx, 0) - 1;
  ivec2 first = ivec2(floor(place - 0.5));
  vec2 between = place - 0.5 - vec2(first);
  vec4 columns = cubic_weights(between.x);
  vec4 rows = cubic_weights(between.y);
  vec4 total = vec4(0.0);
  vec4 low = vec4(3.0e38);
  vec4 high = vec4(-3.0e38);
  for (int j = 0; j < 4; j++) {
    for (int i = 0; i < 4; i++) {
      vec4 texel = texelFetch(tx, clamp(first + ivec2(i, j) - 1, ivec2(0), last), 0);
      total += columns[i] * rows[j] * texel;
      low = min(low, texel);
      high = max(high, texel);
    }
  }
  return clamp(total, low, high);
}

// The blur averages two places along each axis.
vec4 distorted_sample(sampler2D tx, Distorted at)
{
  int n = (length(at.along) > LEAST_SPREAD) ? 2 : 1;
  int m = (length(at.across) > LEAST_SPREAD) ? 2 : 1;
  vec4 total = vec4(0.0);
  for (int j = 0; j < m; j++) {
    for (int i = 0; i < n; i++) {
      vec2 place = at.place;
      place += (n == 2) ? at.along * float(2 * i - 1) : vec2(0.0);
      place += (m == 2) ? at.across * float(2 * j - 1) : vec2(0.0);
      total += cubic_sample(tx, place);
    }
  }
  return total / float(n * m);
}

#endif
