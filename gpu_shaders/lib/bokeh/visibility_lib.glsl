// Visibility of a highlight from places on the lens (methods 11).
//
// The line from a highlight at depth d to the place L on the lens passes, at depth z,
//   xy(z) = a + b z + L (d - z) r        (a = 0, b = xy / d, r = 1 / d; for an orthographic camera
//                                         a = xy, b = 0, r = 1 / focus distance),
// so a point Q hides it from L = (Q.xy - a - b z) / ((d - z) r): projective, and no more than that.
// In the raster of a pinhole at the lens' centre, the line moves from the highlight's place by
// L sweep (w_d - w), where w is the value of the depth buffer: straight and even.
#ifndef VISIBILITY_LIB_GLSL
#define VISIBILITY_LIB_GLSL

// Kinds of a source in `tiles_tx`.
#define SOURCE_DROP 0.0
#define SOURCE_UNMASKED 1.0
#define SOURCE_MASKED 2.0
#define SOURCE_IN_SPLAT 3.0

// Most steps of a ray; longer rays take longer steps.
#define VISIBILITY_STEPS 192

vec4 visibility_opacities(sampler2D opacity_tx, vec2 place)
{
  ivec2 last = textureSize(opacity_tx, 0) - 1;
  return texelFetch(opacity_tx, clamp(ivec2(floor(place)), ivec2(0), last), 0);
}

struct Cone {
  vec2 a;
  vec2 b;
  float depth;  // of the source, m
  float rate;
};

Cone source_cone(vec3 place, vec4 lens)
{
  if (lens.y > 0.5) {
    return Cone(place.xy, vec2(0.0), place.z, 1.0 / lens.x);
  }
  return Cone(vec2(0.0), place.xy / place.z, place.z, 1.0 / place.z);
}

// Homogeneous place on the lens, in units of half the opening, that a point hides: xy over z.
vec3 cone_project(Cone cone, vec3 eye, vec2 opening)
{
  float z = -eye.z;
  return vec3((eye.xy - cone.a - cone.b * z) / opening, (cone.depth - z) * cone.rate);
}

// Depth buffer value of a depth; `sweep` as in VisibilityParams.
float window_depth(float depth, vec4 sweep, bool orthographic)
{
  return orthographic ? sweep.z + sweep.w * depth : sweep.z + sweep.w / depth;
}

// Depth of the farthest surface that counts as an occluder of the source. Surfaces between this depth
// and the source move by less than `same` pixels between places on the lens: as they do not hide the
// source from the centre, they hide it from nowhere. Above all this leaves out the surface that the
// source itself lies on. `lens` as in ViewParams.
float hiding_depth(float depth, vec4 lens, float same)
{
  float move = same / max(lens.z, 1e-30);
  float limit = (lens.y > 0.5) ? depth - move * lens.x : 1.0 / (1.0 / depth + move);
  return min(limit, depth * (1.0 - 1e-5));
}

// Depth buffer values of up to four layers; outside the raster as where there is no surface.
vec4 visibility_layers(sampler2D layers_tx, vec2 place)
{
  ivec2 texel = ivec2(floor(place));
  ivec2 size = textureSize(layers_tx, 0);
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) {
    return vec4(2.0);
  }
  return texelFetch(layers_tx, texel, 0);
}

// Share of the light that passes the surfaces of filtered layers on a step of a ray. The step goes from
// the depth buffer value `here` to `next`, over texels with the surfaces `before` and `after`, which cover
// a and b of them; coverage goes over evenly in between. `joined`: both are one surface.
float passed_filtered(
    float here, float next, vec4 before, vec4 after, vec4 a, vec4 b, vec4 joined)
{
  vec4 from = here - before, to = next - after;
  vec4 at_before = from / (here - next), at_after = (here - after) / (here - next);
  vec4 first = vec4(greaterThan(at_before, vec4(0.0))) * max(1.0 - at_before, 0.0) * a;
  vec4 second = vec4(lessThanEqual(at_after, vec4(1.0))) * max(at_after, 0.0) * b;
  vec4 crosses = vec4(greaterThan(from, vec4(0.0))) * vec4(lessThanEqual(to, vec4(0.0)));
  vec4 covered = crosses * mix(a, b, clamp(from / max(from - to, 1e-30), 0.0, 1.0));
  vec4 passed = mix((1.0 - first) * (1.0 - second), 1.0 - covered, joined);
  return passed.x * passed.y * passed.z * passed.w;
}

// Share of a source's light that reaches a place on the lens through the surfaces of the peeled
// layers.
// opacity_tx: opacity of each layer; place: the source's, texels; depth: its depth buffer value;
// limit: surfaces at larger values are no occluders; nearest: least value of any surface on the way;
// move: texels that the line to that place on the lens moves for each unit of the depth buffer;
// filtered: see VisibilityParams.
// The ray is walked from the source to the lens. Between texels whose surfaces are joined, a layer
// is a height field; elsewhere each texel's surface is flat.
float visibility_cast(sampler2D layers_tx,
                      sampler2D opacity_tx,
                      vec2 place,
                      float depth,
                      float limit,
                      float nearest,
                      vec2 move,
                      bool filtered)
{
  float rate = max(max(abs(move.x), abs(move.y)), 1e-6);
  vec2 way = move / rate;
  float texel = 1.0 / rate;
  float steps = ceil(rate * max(depth - nearest, 0.0));
  float stride = max(1.0, steps / float(VISIBILITY_STEPS));
  vec4 before = visibility_layers(layers_tx, place);
  before = mix(before, vec4(2.0), greaterThan(before, vec4(limit)));
  float here = depth;
  float through = 1.0;
  for (float walked = 0.0; walked <= steps; walked += stride) {
    vec4 after = visibility_layers(layers_tx, place + way * (walked + stride));
    after = mix(after, vec4(2.0), greaterThan(after, vec4(limit)));
    float middle = depth - (walked + 0.5 * stride) * texel;
    float next = depth - (walked + stride) * texel;
    vec4 behind = vec4(greaterThan(vec4(here), before));
    vec4 past = vec4(lessThanEqual(vec4(next), after));
    vec4 joined = vec4(lessThan(abs(before - after), vec4(stride * texel)));
    if (filtered && any(greaterThan(vec4(here), min(before, after)))) {
      vec4 a = visibility_opacities(opacity_tx, place + way * walked);
      vec4 b = visibility_opacities(opacity_tx, place + way * (walked + stride));
      through *= passed_filtered(here, next, before, after, a, b, joined);
      if (through < 1e-3) {
        return 0.0;
      }
    }
    if (filtered) {
      before = after;
      here = next;
      continue;
    }
    vec4 first = behind * vec4(lessThanEqual(vec4(middle), before)) * (1.0 - joined);
    vec4 second = past * mix(vec4(greaterThan(vec4(middle), after)), behind, joined);
    if (any(greaterThan(first + second, vec4(0.0)))) {
      vec4 a = visibility_opacities(opacity_tx, place + way * walked);
      vec4 b = visibility_opacities(opacity_tx, place + way * (walked + stride));
      vec4 passed = (1.0 - first * a) * (1.0 - second * b);
      through *= passed.x * passed.y * passed.z * passed.w;
      if (through < 1e-3) {
        return 0.0;
      }
    }
    before = after;
    here = next;
  }
  return through;
}

// A mask at a place on the lens in units of half the opening, blurred about as much as a pixel
// filter blurs the disc: by a quadratic spline over 3 x 3 texels of its tile.
// tile: x, y, size of a source in `tiles_tx`.
float visibility_mask(sampler2D masks_tx, vec3 tile, vec2 lens)
{
  vec2 place = clamp((lens * 0.5 + 0.5) * tile.z, vec2(0.0), vec2(tile.z - 1e-3));
  vec2 middle = floor(place);
  vec2 part = place - middle - 0.5;
  vec2 weights[3];
  weights[0] = 0.5 * (0.5 - part) * (0.5 - part);
  weights[1] = 0.75 - part * part;
  weights[2] = 0.5 * (0.5 + part) * (0.5 + part);
  float sum = 0.0;
  for (int y = 0; y < 3; y++) {
    for (int x = 0; x < 3; x++) {
      vec2 texel = clamp(middle + vec2(x, y) - 1.0, vec2(0.0), vec2(tile.z - 1.0));
      sum += weights[x].x * weights[y].y * texelFetch(masks_tx, ivec2(tile.xy + texel), 0).x;
    }
  }
  return sum;
}

#endif
