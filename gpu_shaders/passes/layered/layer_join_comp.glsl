// Joins a layer with the one in front of it where a surface goes on from the one into the other, but
// they have no whole texel in common: the layer gets the texels at the open end of the one in front, and
// those that it has a part of whole. Between texels side by side in one layer no ray passes.
// An edge of an object where something behind ends by chance looks alike: the surface is one if the step
// in depth is no more than what it rises by in a few texels on both sides.
// Inputs: layer (from 1), layers, eyes (places on the lens that colours are seen from).
// Changed: colors_img, depths_img, MATTES: mattes_img. What is decided on is what no thread writes: the
// layer in front, and texels of the layer where that one has none.
// Source: none; layers/joining.py does the same where texels are covered in part.

#define EMPTY 1.5
// How far texels of the open end lie from whole ones of the layer: one of which each has a part may be
// between; and texels on each side in which a surface's rise is looked for.
#define NEAR 2
#define REACH 3
#define WHOLE 0.999

// Depth, and the share of the texel that has a surface, 0 without one.
vec2 depth_at(ivec2 texel, int slice)
{
  vec2 found = imageLoad(depths_img, ivec3(texel, slice)).xy;
  return (found.x < EMPTY) ? found : vec2(2.0 * EMPTY, 0.0);
}

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(depths_img).xy;
  if (any(greaterThanEqual(texel, size))) {
    return;
  }
  vec2 own = depth_at(texel, layer), here = depth_at(texel, layer - 1);
  if (own.y > WHOLE || here.y == 0.0) {
    return;
  }
  // Most texels are far from any open end: the step is asked for first.
  float step_to = 2.0 * EMPTY;
  for (int y = -NEAR; y <= NEAR; y++) {
    for (int x = -NEAR; x <= NEAR; x++) {
      ivec2 place = clamp(texel + ivec2(x, y), ivec2(0), size - 1);
      vec2 behind = depth_at(place, layer);
      if (behind.y > WHOLE && depth_at(place, layer - 1).y == 0.0) {
        step_to = min(step_to, abs(behind.x - here.x));
      }
    }
  }
  if (step_to > EMPTY) {
    return;
  }
  if (own.y > 0.0) {
    step_to = max(step_to, abs(own.x - here.x));
  }
  vec2 near_range = vec2(here.x), far_range = vec2(EMPTY, -EMPTY);
  for (int y = -REACH; y <= REACH; y++) {
    for (int x = -REACH; x <= REACH; x++) {
      ivec2 place = clamp(texel + ivec2(x, y), ivec2(0), size - 1);
      vec2 front = depth_at(place, layer - 1), behind = depth_at(place, layer);
      if (front.y > 0.0) {
        near_range = vec2(min(near_range.x, front.x), max(near_range.y, front.x));
      }
      if (front.y == 0.0 && behind.y > WHOLE) {
        far_range = vec2(min(far_range.x, behind.x), max(far_range.y, behind.x));
      }
    }
  }
  if (step_to > near_range.y - near_range.x + far_range.y - far_range.x) {
    return;
  }
  if (own.y > 0.0) {
    imageStore(depths_img, ivec3(texel, layer), vec4(own.x, 1.0, 0.0, 0.0));
    return;
  }
  for (int eye = 0; eye < eyes; eye++) {
    vec4 color = imageLoad(colors_img, ivec3(texel, layer - 1 + eye * layers));
    imageStore(colors_img, ivec3(texel, layer + eye * layers), color);
  }
#ifdef MATTES
  imageStore(mattes_img, ivec3(texel, layer), imageLoad(mattes_img, ivec3(texel, layer - 1)));
#endif
  imageStore(depths_img, ivec3(texel, layer), vec4(here.x, 1.0, 0.0, 0.0));
}
