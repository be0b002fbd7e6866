// A highlight's disc, as far as the lens sees it; the blend state adds it to the others.
// Inputs: v_place, v_density, v_blur, v_tile, v_source, v_region (see splat_vert); splat_buf;
// opening_tx (layers of rising blur); masks_tx (atlas of what each place on the lens sees). IN_SPLAT: sources without a mask cast
// a ray a pixel through layers_tx and opacity_tx; sources_a_tx, states_tx, visibility_buf.
// Outputs: scene-linear light.
// Source: methods 11, 13.
#include "lib/opening_lib.glsl"
#include "lib/visibility_lib.glsl"
#ifdef IN_SPLAT
#include "lib/source_lib.glsl"
#endif

// Share of the light that reaches a place on the lens, in units of half the opening.
float seen_from(vec2 lens)
{
  if (v_tile.w == SOURCE_MASKED) {
    return visibility_mask(masks_tx, v_tile.xyz, lens);
  }
#ifdef IN_SPLAT
  if (v_tile.w == SOURCE_IN_SPLAT) {
    ivec2 texel = list_texel(v_source);
    Source source = source_of(texelFetch(sources_a_tx, texel, 0), visibility_buf);
    return visibility_cast(layers_tx,
                           opacity_tx,
                           source.place,
                           source.depth,
                           source.limit,
                           texelFetch(states_tx, texel, 0).x,
                           lens * source_reach(visibility_buf));
  }
#endif
  return 1.0;
}

// Weight of the region that the source stands for: hats over a grid of regions, which add up to 1.
float region_weight(vec2 lens)
{
  if (v_region < 0.5) {
    return 1.0;
  }
  float side = splat_buf.opening.w;
  float number = v_region - 1.0;
  vec2 node = vec2(mod(number, side), floor((number + 0.5) / side));
  vec2 place = clamp((lens * 0.5 + 0.5) * side - 0.5, 0.0, side - 1.0);
  vec2 hat = max(1.0 - abs(place - node), 0.0);
  return hat.x * hat.y;
}

void main()
{
  vec3 density = v_density * opening_density(opening_tx, v_place, v_blur);
  if (max(density.r, max(density.g, density.b)) > 0.0) {
    // Beyond the rim, what is blurred belongs to the rim.
    vec2 lens = v_place / max(length(v_place), 1.0);
    density *= seen_from(lens) * region_weight(lens);
  }
  out_color = vec4(density, 0.0);
}
