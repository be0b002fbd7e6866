// Image look-ups in full float precision: the texture unit weighs texels with 8 bits, which is not
// enough to agree with Cycles. Texels are fetched as stored; decoding comes after interpolation.
#ifndef TEXTURE_LIB_GLSL
#define TEXTURE_LIB_GLSL

#define EXTENSION_REPEAT 0
#define EXTENSION_EXTEND 1
#define EXTENSION_CLIP 2
#define EXTENSION_MIRROR 3

// i modulo size, not negative; GLSL leaves % of negative numbers open.
int wrap_index(int i, int size)
{
  return i - size * int(floor(float(i) / float(size)));
}

// Texel index on an endless line of copies to an index in [0, size).
int extend_texel(int i, int size, int extension)
{
  if (extension == EXTENSION_REPEAT) {
    return wrap_index(i, size);
  }
  if (extension == EXTENSION_MIRROR) {
    int r = wrap_index(i, 2 * size);
    return (r < size) ? r : 2 * size - 1 - r;
  }
  return clamp(i, 0, size - 1);
}

vec4 image_texel(sampler2D tx, ivec2 texel, ivec2 size, int extension)
{
  bool outside = any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size));
  if (extension == EXTENSION_CLIP && outside) {
    return vec4(0.0);
  }
  ivec2 place = ivec2(extend_texel(texel.x, size.x, extension),
                      extend_texel(texel.y, size.y, extension));
  return texelFetch(tx, place, 0);
}

vec4 image_closest(sampler2D tx, vec2 uv, int extension)
{
  ivec2 size = textureSize(tx, 0);
  return image_texel(tx, ivec2(floor(uv * vec2(size))), size, extension);
}

vec4 image_linear(sampler2D tx, vec2 uv, int extension)
{
  ivec2 size = textureSize(tx, 0);
  vec2 place = uv * vec2(size) - 0.5;
  vec2 corner = floor(place);
  vec2 t = place - corner;
  ivec2 texel = ivec2(corner);
  vec4 a = image_texel(tx, texel, size, extension);
  vec4 b = image_texel(tx, texel + ivec2(1, 0), size, extension);
  vec4 c = image_texel(tx, texel + ivec2(0, 1), size, extension);
  vec4 d = image_texel(tx, texel + ivec2(1, 1), size, extension);
  return mix(mix(a, b, t.x), mix(c, d, t.x), t.y);
}

// Weights of a uniform cubic B-spline.
vec4 cubic_weights(float t)
{
  float r = 1.0 - t;
  return vec4(r * r * r,
              3.0 * t * t * t - 6.0 * t * t + 4.0,
              3.0 * r * r * r - 6.0 * r * r + 4.0,
              t * t * t) / 6.0;
}

vec4 image_cubic(sampler2D tx, vec2 uv, int extension)
{
  ivec2 size = textureSize(tx, 0);
  vec2 place = uv * vec2(size) - 0.5;
  vec2 corner = floor(place);
  ivec2 texel = ivec2(corner) - 1;
  vec4 x = cubic_weights(place.x - corner.x), y = cubic_weights(place.y - corner.y);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 16; i++) {
    ivec2 step = ivec2(i & 3, i >> 2);
    sum += x[step.x] * y[step.y] * image_texel(tx, texel + step, size, extension);
  }
  return sum;
}

// Colour that was multiplied by alpha before interpolation.
vec4 image_unassociate(vec4 texel)
{
  return (texel.a != 0.0 && texel.a != 1.0) ? vec4(texel.rgb / texel.a, texel.a) : texel;
}

#endif
