// Puts a drawn slice of the scene into a layer: colours as they are, depths in the depth buffer's values of
// the whole frame. A texel whose middle misses a surface that reaches into it has the colour of the texel
// beside it that shows that surface.
// Inputs: color_tx, depth_tx, MATTES: mattes_tx (the slice's); shape_tx (its depths, parts times as fine
// along each side); layer; color_layer (that of its colour);
// slice, whole (rows of the projections that make clip z and w of z in camera space: z's factor and
// offset, w's factor and offset).
// Outputs: colors_img, depths_img (depth, 2 without a surface; share of the texel that has one), MATTES:
// mattes_img.

// Depth of a part of a texel whose middle is empty, 1: none; and how many have one.
vec2 shape_of(ivec2 texel)
{
  float found = 1.0, away = 1e9, there = 0.0;
  for (int i = 0; i < parts * parts; i++) {
    ivec2 part = ivec2(i % parts, i / parts);
    float depth = texelFetch(shape_tx, texel * parts + part, 0).x;
    vec2 from_middle = vec2(part) - 0.5 * float(parts - 1);
    float distance_to = dot(from_middle, from_middle);
    there += (depth < 1.0) ? 1.0 : 0.0;
    if (depth < 1.0 && distance_to < away) {
      away = distance_to;
      found = depth;
    }
  }
  return vec2(found, there);
}

void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(depth_tx, 0);
  if (any(greaterThanEqual(texel, size))) {
    return;
  }
  float seen = texelFetch(depth_tx, texel, 0).x, share = (seen < 1.0) ? 1.0 : 0.0;
  ivec2 shown = texel;
  if (parts > 1) {
    vec2 shape = shape_of(texel);
    share = max(share, shape.y) / float(parts * parts);
    if (seen >= 1.0 && shape.y > 0.0) {
      float nearest = 1.0;
      for (int i = 0; i < 9; i++) {
        ivec2 place = clamp(texel + ivec2(i % 3, i / 3) - 1, ivec2(0), size - 1);
        float depth = texelFetch(depth_tx, place, 0).x;
        if (depth < 1.0 && abs(depth - shape.x) < nearest) {
          nearest = abs(depth - shape.x);
          seen = shape.x;
          shown = place;
        }
      }
    }
  }
  float depth = 2.0;
  if (seen < 1.0) {
    float ndc = 2.0 * seen - 1.0;
    float z = (ndc * slice.w - slice.y) / (slice.x - ndc * slice.z);
    depth = 0.5 * (whole.x * z + whole.y) / (whole.z * z + whole.w) + 0.5;
  }
  ivec3 place = ivec3(texel, layer);
  imageStore(colors_img, ivec3(texel, color_layer), clamp(texelFetch(color_tx, shown, 0), -65504.0, 65504.0));
  imageStore(depths_img, place, vec4(depth, share, 0.0, 0.0));
#ifdef MATTES
  imageStore(mattes_img, place, texelFetch(mattes_tx, shown, 0));
#endif
}
