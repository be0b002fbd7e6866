// Culls sources that need no visibility mask: their disc is outside the frame, they are hidden from the
// whole lens, or no surface is in front of them.
// Inputs: sources_tx (x, y, depth, extent); visibility_buf; count. LAYERS: layers_tx, bounds_tx (see
// bokeh_culling_bounds_comp); cell; again (1: only sources that are still undecided). Without
// LAYERS, only the frame is tested.
// Outputs: states_img: least depth buffer value of any surface in front of the source (x); weighted sum
// (y) and weights (z) of the blur of its occluders (see occluder_blur_lib); state (w).
// Source: methods 10 (J20 section 4.3.2).
#include "lib/bokeh/source_lib.glsl"
#ifdef LAYERS
#include "lib/bokeh/bounds_lib.glsl"
#endif

// Iterations that narrow the depth bounds; they hardly shrink after the third.
#define ITERATIONS 4
// Least step of depth between texels that counts as a gap, in texels that a line moves over that step.
#define GAP 0.25
// Largest side of a rectangle, texels, that is tested texel by texel.
#define WALK 24

// Whether the disc meets the frame.
bool in_frame(Source source, float extent)
{
  vec2 radius = source.coc * visibility_buf.opening.w * vec2(1.0 / visibility_buf.lens.w, 1.0);
  vec2 center = source.place / visibility_buf.raster.z - visibility_buf.frame.xy;
  vec4 axis = visibility_buf.projection * vec4(0.0, 0.0, -1.0, 1.0);
  vec2 away = source.place - (axis.xy / axis.w * 0.5 + 0.5) * visibility_buf.raster.xy;
  vec2 moved = abs(away) * (visibility_buf.colors.z / visibility_buf.raster.z);
  // Margin for the blur of the disc by the extent of the source and the pixel filter.
  vec2 reach = radius + moved + 1.5 * extent + 4.0;
  return all(greaterThan(center + reach, vec2(0.0))) &&
         all(lessThan(center - reach, visibility_buf.frame.zw));
}

#ifdef LAYERS
// Whether the surface of a texel goes on in its neighbours.
bool joined(ivec2 texel, float depth, float most)
{
  ivec2 last = textureSize(layers_tx, 0) - 1;
  for (int i = 0; i < 4; i++) {
    ivec2 step_aside = ivec2((i & 1) * 2 - 1, 0);
    ivec2 next = clamp(texel + ((i & 2) == 0 ? step_aside : step_aside.yx), ivec2(0), last);
    if (abs(texelFetch(layers_tx, next, 0).x - depth) > most) {
      return false;
    }
  }
  return true;
}

// Whether no surface in a rectangle of texels lies on a line from the source to the lens.
bool free_of_texels(Source source, ivec2 low, ivec2 high)
{
  vec2 rate = source_reach(visibility_buf);
  float most = 1.0 / max(rate.x, rate.y);
  bool filtered = visibility_buf.layers.x > 0.5;
  // How far a texel's surface reaches from its middle.
  float side = filtered ? 1.0 : 0.5;
  for (int y = low.y; y <= high.y; y++) {
    for (int x = low.x; x <= high.x; x++) {
      float depth = texelFetch(layers_tx, ivec2(x, y), 0).x;
      if (depth >= source.limit) {
        continue;
      }
      vec2 offset = abs(vec2(x, y) + 0.5 - source.place);
      vec2 reach = rate * (source.depth - depth);
      if (all(lessThanEqual(offset - side, reach))) {
        // Inside a surface the texel's middle decides; at its edge any part of the texel.
        bool decided = filtered || all(lessThanEqual(offset, reach));
        if (decided || !joined(ivec2(x, y), depth, most)) {
          return false;
        }
      }
    }
  }
  return true;
}

float state_of(Source source, inout float nearest)
{
  vec2 rate = source_reach(visibility_buf);
  ivec2 size = textureSize(layers_tx, 0);
  bool inside, all_inside = true;
  vec3 bounds;
  ivec2 low, high;
  for (int i = 0; i < ITERATIONS; i++) {
    vec2 reach = rate * max(source.depth - nearest, 0.0) + visibility_buf.layers.x;
    low = ivec2(floor(source.place - reach));
    high = ivec2(floor(source.place + reach));
    inside = all(greaterThanEqual(low, ivec2(0))) && all(lessThan(high, size));
    all_inside = all_inside && inside;
    low = clamp(low, ivec2(0), size - 1);
    high = clamp(high, ivec2(0), size - 1);
    bounds = bounds_of(bounds_tx, low / cell, high / cell);
    float next = clamp(bounds.x, nearest, source.depth);
    if (next == nearest) {
      break;
    }
    nearest = next;
  }
  ivec2 extent = high - low + 1;
  if (bounds.x >= source.limit ||
      (max(extent.x, extent.y) <= WALK && free_of_texels(source, low, high)))
  {
    // Near the lens, in front of all surfaces of the layers, the cone may leave the raster.
    return all_inside ? STATE_VISIBLE : STATE_EDGE;
  }
  // An opaque surface without a gap that a line to the lens could pass hides the source.
  if (inside && bounds.y < source.limit && bounds.z * max(rate.x, rate.y) < GAP) {
    return STATE_HIDDEN;
  }
  return STATE_OPEN;
}
#endif

void main()
{
  int index = int(gl_GlobalInvocationID.x);
  if (index >= count) {
    return;
  }
  ivec2 texel = list_texel(index);
#ifdef LAYERS
  if (again == 1 && imageLoad(states_img, texel).w != STATE_OPEN) {
    return;
  }
#endif
  vec4 a = texelFetch(sources_tx, texel, 0);
  Source source = source_of(a, visibility_buf);
  float state = in_frame(source, a.w) ? STATE_OPEN : STATE_OUTSIDE;
#ifdef LAYERS
  float nearest = 0.0;
  if (state == STATE_OPEN) {
    state = state_of(source, nearest);
  }
#else
  float nearest = source.depth;
#endif
  imageStore(states_img, texel, vec4(nearest, 0.0, 0.0, state));
}
