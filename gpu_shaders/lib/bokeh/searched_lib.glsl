// Which points the search for highlights sees: it ends at the edges of its raster, and what lies beyond
// stays with the lens samples.
#ifndef SEARCHED_LIB_GLSL
#define SEARCHED_LIB_GLSL
#include "lib/lens_lib.glsl"

// 1 if a point of camera space, or with w 0 a direction, lies in the raster of the search; else 0.
float searched(vec4 eye, HighlightParams params)
{
  vec4 clip = params.raster * eye;
  return all(lessThanEqual(abs(clip.xy), vec2(clip.w))) ? 1.0 : 0.0;
}

// The same for a point that is searched from several places on the lens, as its share of the light
// that the place `lens_xy` sees: what each of them finds counts around it (region_weight of
// splat_frag.glsl). `focus_distance` in m.
float searched_from_views(vec3 eye, vec2 lens_xy, float focus_distance, HighlightParams params)
{
  float side = params.views.z;
  vec2 place = clamp((lens_xy / params.views.xy * 0.5 + 0.5) * side - 0.5, 0.0, side - 1.0);
  float share = 0.0;
  for (int i = 0; i < 4; i++) {
    vec2 node = floor(place) + vec2(i & 1, i >> 1);
    vec2 hat = max(1.0 - abs(place - node), 0.0);
    vec2 view = ((2.0 * node + 1.0) / side - 1.0) * params.views.xy;
    vec3 seen = lens_displace(eye, view, focus_distance);
    share += hat.x * hat.y * searched(vec4(seen, 1.0), params);
  }
  return share;
}

// Whether the plane of a surface cuts the lens' opening: parts of the lens see its other side, which is
// lit otherwise, or none of it. `eye`, `normal`: a point and the surface's normal there, in camera space;
// `lens` as in ViewParams.
bool seen_from_both_sides(vec3 eye, vec3 normal, vec4 lens, HighlightParams params)
{
  float middle = (lens.y > 0.5) ? normal.z * lens.x : dot(normal, eye);
  return abs(middle) < length(normal.xy * params.views.xy);
}

#endif
