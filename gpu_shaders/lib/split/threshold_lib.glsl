// Which light is a highlight where the threshold is automatic: what is several times brighter than its
// surroundings, the mean brightness in its own circle of confusion as the lens' middle sees the picture,
// without what lies in front of it. Lens samples draw the rest. A function of the point alone, so that
// lens samples leave out what is splatted, from wherever the point is seen. Without automatic: the same
// threshold everywhere.
// Surroundings are known for eight depths, by their parallax against what is infinitely far.
// Source: addon/sampling/highlights.py.
#ifndef THRESHOLD_LIB_GLSL
#define THRESHOLD_LIB_GLSL

// Parallaxes grow from 0 by FIRST px, and then by the power of 2 in GROWTH from depth to depth.
#define DEPTHS 8
#define FIRST 2.0
#define GROWTH 0.9

// Parallax of a depth, px; beyond the last one there is no bound.
float parallax_of_depth(int depth)
{
  return (depth < DEPTHS) ? FIRST * (exp2(GROWTH * float(depth)) - 1.0) : 1e30;
}

// Where a point of camera space, or with w 0 a direction, lies in the raster of the search, as clip
// coordinates.
vec2 place_in_search(vec4 eye, HighlightParams params)
{
  vec4 clip = params.raster * eye;
  return clip.xy / max(clip.w, 1e-6);
}

// Mean brightness around a place, given as of `place_in_search`, within its circle of confusion of the
// radius `coc_px`.
float surroundings(vec2 place, float coc_px, HighlightParams params, sampler2D surroundings_tx)
{
  vec2 texels = params.size.zw;
  vec2 at = clamp((place * 0.5 + 0.5) * params.size.xy * 0.5, vec2(0.5), texels - 0.5);
  vec2 from = at / vec2(2.0 * texels.x, texels.y);
  float depth = log2(1.0 + max(params.split.w - coc_px, 0.0) / FIRST) / GROWTH;
  depth = min(depth, float(DEPTHS - 1));
  vec4 far = max(1.0 - abs(depth - vec4(0.0, 1.0, 2.0, 3.0)), 0.0);
  vec4 near = max(1.0 - abs(depth - vec4(4.0, 5.0, 6.0, 7.0)), 0.0);
  return dot(far, texture(surroundings_tx, from)) +
         dot(near, texture(surroundings_tx, from + vec2(0.5, 0.0)));
}

// Threshold of the largest channel.
float highlight_threshold(vec2 place, float coc_px, HighlightParams params, sampler2D surroundings_tx)
{
  return max(params.split.x,
             params.automatic.x * surroundings(place, coc_px, params, surroundings_tx));
}

// Whether reflecting surfaces are searched for highlights at a place, as of `place_in_search`.
bool reflections_searched(vec2 place, HighlightParams params, usampler2D candidates_tx)
{
  ivec2 tile = ivec2(floor((place * 0.5 + 0.5) * params.automatic.zw));
  return texelFetch(candidates_tx, clamp(tile, ivec2(0), textureSize(candidates_tx, 0) - 1), 0).x != 0u;
}

#endif
