// One layer of a stack of N-buffers over cells of the peeled raster.
// Inputs: layers_tx, opacity_tx (see visibility_pack_comp); level (of the layer that is made);
// cell (texels along a side of a cell).
// Outputs: bounds_img, over the square of 2^level cells that begins at the cell: least depth buffer
// value of any surface (x), largest value of the first opaque surface (y; 2 where there is none), and
// by how much that value changes from a texel to the next at most (z).
// Source: methods 5 (Decoret, EG 2005), 10.
#include "lib/bokeh/bounds_lib.glsl"

float opaque_depth(ivec2 texel)
{
  ivec2 place = min(texel, textureSize(layers_tx, 0) - 1);
  vec4 depth = texelFetch(layers_tx, place, 0);
  vec4 opacity = texelFetch(opacity_tx, place, 0);
  vec4 opaque = mix(vec4(2.0), depth, greaterThan(opacity, vec4(0.998)));
  return min(min(opaque.x, opaque.y), min(opaque.z, opaque.w));
}

void main()
{
  ivec2 size = imageSize(bounds_img).xy;
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(place, size))) {
    return;
  }
  vec3 result;
  if (level == 0) {
    result = vec3(2.0, 0.0, 0.0);
    ivec2 last = min((place + 1) * cell, textureSize(layers_tx, 0));
    for (int y = place.y * cell; y < last.y; y++) {
      for (int x = place.x * cell; x < last.x; x++) {
        float depth = opaque_depth(ivec2(x, y));
        float jump = max(abs(opaque_depth(ivec2(x + 1, y)) - depth),
                         abs(opaque_depth(ivec2(x, y + 1)) - depth));
        float nearest = texelFetch(layers_tx, ivec2(x, y), 0).x;
        result = bounds_join(result, vec3(nearest, depth, jump));
      }
    }
  }
  else {
    ivec2 next = min(place + (1 << (level - 1)), size - 1);
    result = bounds_join(
        bounds_join(imageLoad(bounds_img, ivec3(place, level - 1)).xyz,
                    imageLoad(bounds_img, ivec3(next.x, place.y, level - 1)).xyz),
        bounds_join(imageLoad(bounds_img, ivec3(place.x, next.y, level - 1)).xyz,
                    imageLoad(bounds_img, ivec3(next, level - 1)).xyz));
  }
  imageStore(bounds_img, ivec3(place, level), vec4(result, 0.0));
}
