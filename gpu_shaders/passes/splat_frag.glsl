// A highlight's disc, as far as the lens sees it; the blend state adds it to the others.
// Inputs: v_place, v_density, v_blur, v_tile, v_source (see splat_vert); opening_tx (layers of rising
// blur); masks_tx (atlas of what each place on the lens sees). IN_SPLAT: sources without a mask cast
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

void main()
{
  vec3 density = v_density * opening_density(opening_tx, v_place, v_blur);
  if (max(density.r, max(density.g, density.b)) > 0.0) {
    // Beyond the rim, what is blurred belongs to the rim.
    density *= seen_from(v_place / max(length(v_place), 1.0));
  }
  out_color = vec4(density, 0.0);
}
