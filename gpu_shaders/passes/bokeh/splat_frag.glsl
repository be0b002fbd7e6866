// The disc of a highlight, masked by its visibility from the lens; the blend state adds discs up.
// Inputs: v_place, v_density, v_blur, v_tile, v_source, v_region (see splat_vert); splat_buf;
// opening_tx (layers of rising blur); masks_tx (atlas of visibility masks over the lens). IN_SPLAT: a
// ray a pixel is cast through layers_tx and opacity_tx for sources without a mask; sources_a_tx,
// states_tx, visibility_buf. CHROMATIC: v_area, v_dot (1: the disc is about a pixel wide).
// Outputs: scene-linear light.
// Source: methods 11, 13.
#include "lib/bokeh/visibility_lib.glsl"
#include "lib/bokeh/disc_lib.glsl"
#ifdef IN_SPLAT
#include "lib/bokeh/occluder_blur_lib.glsl"

// Parts along a side of the square that a merged source stands for, a ray each.
#define PARTS 3
// Sources of a smaller extent, px, cast one ray.
#define LEAST_EXTENT 1.01

// Visibility of a merged source, averaged over its parts. Occluders have a parallax across the source,
// and the parts' discs are shifted, too: a ray from each part, to the place on the lens that its own
// disc has at this pixel. The mean is the blur of lib/bokeh/occluder_blur_lib.glsl.
float seen_from_parts(Source source, float extent, float nearest, vec2 lens)
{
  vec2 reach = source_reach(visibility_buf);
  vec4 focused = vec4(visibility_buf.colors.w, visibility_buf.lens.yzw);
  float coc = coc_radius_px(source.cone.depth, focused);
  int side = (extent > LEAST_EXTENT && abs(coc) > 0.1) ? PARTS : 1;
  float sum = 0.0;
  for (int part = 0; part < side * side; part++) {
    vec2 offset = ((vec2(part % side, part / side) + 0.5) / float(side) - 0.5) * extent;
    vec2 place = (side > 1) ? lens - offset / coc * vec2(splat_buf.opening.x, 1.0) : lens;
    // Its own disc does not reach farther than the opening.
    place /= max(length(place), 1.0);
    sum += visibility_cast(layers_tx,
                           opacity_tx,
                           source.place + offset * visibility_buf.raster.z,
                           source.depth,
                           source.limit,
                           nearest,
                           place * reach,
                           visibility_buf.layers.x > 0.5);
  }
  return sum / float(side * side);
}
#endif

// Share of the source's light that reaches a place on the lens; `lens` in units of half the opening.
float seen_from(vec2 lens)
{
  if (v_tile.w == SOURCE_MASKED) {
    return visibility_mask(masks_tx, v_tile.xyz, lens);
  }
#ifdef IN_SPLAT
  if (v_tile.w == SOURCE_IN_SPLAT) {
    ivec2 texel = list_texel(v_source);
    vec4 a = texelFetch(sources_a_tx, texel, 0);
    float nearest = texelFetch(states_tx, texel, 0).x;
    return seen_from_parts(source_of(a, visibility_buf), a.w, nearest, lens);
  }
#endif
  return 1.0;
}

void main()
{
  vec2 lens;
  vec3 density = v_density * disc_density(v_place, lens);
  if (max(density.r, max(density.g, density.b)) > 0.0) {
    density *= seen_from(lens);
#ifdef CHROMATIC
    density *= (v_dot > 0.5) ? 1.0 : region_weight(lens);
    density *= max(v_area.x + dot(v_area.yz, lens), 0.0);
#else
    density *= region_weight(lens);
#endif
  }
  out_color = vec4(density, 0.0);
}
