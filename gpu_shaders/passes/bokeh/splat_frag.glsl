// The disc of a highlight, masked by its visibility from the lens; the blend state adds discs up.
// Inputs: v_place, v_density, v_blur, v_tile, v_source, v_region (see splat_vert); splat_buf;
// opening_tx (layers of rising blur); masks_tx (atlas of visibility masks over the lens). IN_SPLAT: a
// ray a pixel is cast through layers_tx and opacity_tx for sources without a mask; sources_a_tx,
// states_tx, visibility_buf. CHROMATIC: v_area, v_dot (1: the disc is about a pixel wide).
// Outputs: scene-linear light.
// Source: methods 11, 13.
#include "lib/bokeh/opening_lib.glsl"
#include "lib/bokeh/visibility_lib.glsl"
#include "lib/bokeh/bokeh_look_lib.glsl"
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
                           place * reach);
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

// Weight of the lens region that the source was seen from: tents over a grid of regions, which sum to 1.
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

#if defined(PROFILE) || defined(RIMS)
// Light density of one layer of blur; `left`: share that the rims let pass, by which it is divided so
// that the disc keeps its energy.
vec3 layer_density(float layer, vec3 left)
{
  vec3 density = opening_layer(opening_tx, v_place, layer);
#ifdef PROFILE
  float radius = length(v_place) / opening_extent(layer);
  density *= profile_texel(profile_tx, radius, v_row, layer).rgb;
#endif
#ifdef RIMS
  for (int i = 0; i < int(splat_buf.field.y); i++) {
    density *= rim_share(splat_buf.rims[i], v_place, v_chief, layer);
  }
#endif
  return density / left;
}
#endif

// Light density per unit of area, and the place on the lens that the light has come through.
vec3 disc_density(out vec2 lens)
{
  // Light that is blurred beyond the rim has come through the rim.
  lens = v_place / max(length(v_place), 1.0);
#ifdef CHROMATIC
  if (v_dot > 0.5) {
    vec2 tent = max(1.0 - abs(v_place), 0.0);
    return vec3(tent.x * tent.y);
  }
#endif
#ifdef TILES
  vec2 away = azimuth_of(v_chief);
  vec3 light = tile_light(sharp_tx, soft_tx, v_place, v_blur, v_tile_at);
  // The even disc that the lens' pattern is blended with (Lens Profile below 1).
  float edge = clamp(0.5 + (1.0 - length(v_place)) / max(v_blur, 1e-6), 0.0, 1.0);
  light.x = mix(edge / 3.14159265, light.x, splat_buf.rows.w);
  light.yz = mix(lens * v_upright, light.yz, splat_buf.rows.w);
  lens = light.y * vec2(away.y, -away.x) + light.z * away;
  lens /= max(length(lens), 1.0);
  vec3 density = vec3(light.x);
  if (splat_buf.field.w > 0.5) {
    vec2 layers = opening_layers(float(textureSize(opening_tx, 0).z), v_blur);
    density *= mix(opening_layer(opening_tx, lens, layers.x) / v_left_lower,
                   opening_layer(opening_tx, lens, layers.x + 1.0) / v_left_upper,
                   layers.y);
  }
  return density;
#elif defined(PROFILE) || defined(RIMS)
  vec2 layers = opening_layers(float(textureSize(opening_tx, 0).z), v_blur);
#ifdef RIMS
  vec3 left_lower = v_left_lower;
  vec3 left_upper = v_left_upper;
#else
  vec3 left_lower = vec3(1.0);
  vec3 left_upper = vec3(1.0);
#endif
  vec3 density = layer_density(layers.x, left_lower);
  if (layers.y > 0.0) {
    density = mix(density, layer_density(layers.x + 1.0, left_upper), layers.y);
  }
  return density;
#else
  return opening_density(opening_tx, v_place, v_blur);
#endif
}

void main()
{
  vec2 lens;
  vec3 density = v_density * disc_density(lens);
  if (max(density.r, max(density.g, density.b)) > 0.0) {
    density *= seen_from(lens) * region_weight(lens);
#ifdef CHROMATIC
    density *= max(v_area.x + dot(v_area.yz, lens), 0.0);
#endif
  }
  out_color = vec4(density, 0.0);
}
