// Light density of a highlight's disc, for the pass that splats it and the one that weighs it before.
// Reads the varyings and textures of splat_vert and splat_frag (PROFILE, RIMS, TILES, OPENED, CHROMATIC).
// Source: methods 13.
#ifndef DISC_LIB_GLSL
#define DISC_LIB_GLSL
#include "lib/bokeh/bokeh_look_lib.glsl"

#if defined(PROFILE) || defined(RIMS)
// Light density of one layer of blur at a place on the opening; `left`: share that the rims let pass,
// by which it is divided so that the disc keeps its energy.
vec3 layer_density(vec2 place, float layer, vec3 left)
{
  vec3 density = opening_layer(opening_tx, place, layer);
#ifdef PROFILE
  float radius = length(place) / opening_extent(layer);
  density *= profile_texel(profile_tx, radius, v_row, layer).rgb;
#endif
#ifdef RIMS
  for (int i = 0; i < int(splat_buf.field.y); i++) {
    density *= rim_share(splat_buf.rims[i], place, v_chief, layer);
  }
#endif
  return density / left;
}
#endif

// Light density per unit of area at a place on the opening, and the place on the lens that the light
// has come through.
vec3 disc_density(vec2 place, out vec2 lens)
{
  // Light that is blurred beyond the rim has come through the rim.
  lens = place / max(length(place), 1.0);
#ifdef CHROMATIC
  if (v_dot > 0.5) {
    vec2 tent = max(1.0 - abs(place), 0.0);
    return vec3(tent.x * tent.y);
  }
#endif
#ifdef TILES
  vec3 light = tile_light(sharp_tx, soft_tx, place, v_blur, v_tile_at);
  // The even disc that the lens' pattern is blended with (Lens Profile below 1).
  float edge = clamp(0.5 + (1.0 - length(place)) / max(v_blur, 1e-6), 0.0, 1.0);
  light.x = mix(edge / 3.14159265, light.x, splat_buf.rows.w);
  light.yz = mix(lens * v_upright, light.yz, splat_buf.rows.w);
  lens = tile_axes(v_chief) * light.yz;
  lens /= max(length(lens), 1.0);
  vec3 density = vec3(light.x);
#ifdef OPENED
  vec2 layers = opening_layers(float(textureSize(opening_tx, 0).z), v_blur);
  density *= mix(opening_layer(opening_tx, lens, layers.x) / v_left_lower,
                 opening_layer(opening_tx, lens, layers.x + 1.0) / v_left_upper,
                 layers.y);
#endif
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
  vec3 density = layer_density(place, layers.x, left_lower);
  if (layers.y > 0.0) {
    density = mix(density, layer_density(place, layers.x + 1.0, left_upper), layers.y);
  }
  return density;
#else
  return opening_density(opening_tx, place, v_blur);
#endif
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

#endif
