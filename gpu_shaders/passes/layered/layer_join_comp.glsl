// Joins a layer with the one in front of it where a surface goes on from the one into the other, but
// they have no texel in common: the layer gets the texels at the open end of the one in front. Between
// texels side by side in one layer no ray passes.
// An edge of an object where something behind ends by chance looks alike: the surface is one if the step
// in depth is no more than what it rises by in a few texels on both sides.
// Inputs: layer (from 1), layers, eyes (places on the lens that colours are seen from).
// Changed: colors_img, depths_img, MATTES: mattes_img. What is decided on is what no thread writes: the
// layer in front, and texels of the layer where that one has none.
// Source: none; layers/joining.py does the same where texels are covered in part.

#define EMPTY 1.5
// Texels on each side in which a surface's rise is looked for.
#define REACH 2

float depth_at(ivec2 texel, int slice)
{
  return imageLoad(depths_img, ivec3(texel, slice)).x;
}

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(depths_img).xy;
  if (any(greaterThanEqual(texel, size)) || depth_at(texel, layer) < EMPTY) {
    return;
  }
  float here = depth_at(texel, layer - 1);
  if (here > EMPTY) {
    return;
  }
  // Most texels are far from any open end: the step is asked for first.
  float step_to = 2.0 * EMPTY;
  for (int i = 0; i < 9; i++) {
    ivec2 place = clamp(texel + ivec2(i % 3, i / 3) - 1, ivec2(0), size - 1);
    float behind = depth_at(place, layer);
    if (behind < EMPTY && depth_at(place, layer - 1) > EMPTY) {
      step_to = min(step_to, abs(behind - here));
    }
  }
  if (step_to > EMPTY) {
    return;
  }
  vec2 near_range = vec2(here), far_range = vec2(EMPTY, -EMPTY);
  for (int y = -REACH; y <= REACH; y++) {
    for (int x = -REACH; x <= REACH; x++) {
      ivec2 place = clamp(texel + ivec2(x, y), ivec2(0), size - 1);
      float front = depth_at(place, layer - 1);
      if (front < EMPTY) {
        near_range = vec2(min(near_range.x, front), max(near_range.y, front));
        continue;
      }
      float behind = depth_at(place, layer);
      if (behind < EMPTY) {
        far_range = vec2(min(far_range.x, behind), max(far_range.y, behind));
      }
    }
  }
  if (step_to > near_range.y - near_range.x + far_range.y - far_range.x) {
    return;
  }
  for (int eye = 0; eye < eyes; eye++) {
    vec4 color = imageLoad(colors_img, ivec3(texel, layer - 1 + eye * layers));
    imageStore(colors_img, ivec3(texel, layer + eye * layers), color);
  }
#ifdef MATTES
  imageStore(mattes_img, ivec3(texel, layer), imageLoad(mattes_img, ivec3(texel, layer - 1)));
#endif
  imageStore(depths_img, ivec3(texel, layer), vec4(here, 0.0, 0.0, 0.0));
}
