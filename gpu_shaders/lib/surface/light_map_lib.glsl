// Which light samples do not reach a point, from their light maps (addon/passes/surface/light_map.py).
// A light sample is a row of the light table below the lights: number of its light, -1 for the sky, and
// number of views (z); its place or direction, and of the sky which group of a lens sample's directions it
// is of (w, 0 or 1); of the sky what it stands for; and for each view 5 texels: origin, and whether it is parallel;
// across, to the edge of the map at distance 1 (parallel: at any), and the least depth; up, and the
// largest; along, of unit length, and the size of a texel at distance 1 (parallel: at any), m; the map's
// corner and size in the atlas, texels.
#ifndef LIGHT_MAP_LIB_GLSL
#define LIGHT_MAP_LIB_GLSL

// Must agree with passes/surface/light_map.py.
#define LIGHT_HEAD_TEXELS 3
#define LIGHT_VIEW_TEXELS 5
// What hides a point lies this many texels before the plane of its triangle at least: what is curved
// inwards lies before it. More where light grazes it, at most so many.
#define LIGHT_BIAS 0.1
#define LIGHT_SLOPE_BIAS 0.03
#define LIGHT_MOST_BIAS 1.0
// Of a depth: of its rounding.
#define LIGHT_ROUNDING 2e-6

// Whether something lies between the point and the light's place. `normal`: of the triangle, of any
// length and side; `slack`: how far from the true surface the point may be, m.
bool light_map_hides(
    sampler2D lights_tx, sampler2D maps_tx, int row, vec3 position, vec3 normal, float slack)
{
  int views = int(texelFetch(lights_tx, ivec2(0, row), 0).z + 0.5);
  for (int i = 0; i < views; i++) {
    int at = LIGHT_HEAD_TEXELS + i * LIGHT_VIEW_TEXELS;
    vec4 origin = texelFetch(lights_tx, ivec2(at, row), 0);
    vec4 across = texelFetch(lights_tx, ivec2(at + 1, row), 0);
    vec4 up = texelFetch(lights_tx, ivec2(at + 2, row), 0);
    vec4 along = texelFetch(lights_tx, ivec2(at + 3, row), 0);
    bool parallel = origin.w > 0.5;
    vec3 offset = position - origin.xyz;
    float depth = dot(offset, along.xyz);
    // A slice has nothing of what is behind it.
    if (depth <= across.w || depth > up.w) {
      continue;
    }
    vec2 place = vec2(dot(offset, across.xyz) / dot(across.xyz, across.xyz),
                      dot(offset, up.xyz) / dot(up.xyz, up.xyz));
    place = parallel ? place : place / depth;
    if (max(abs(place.x), abs(place.y)) >= 1.0) {
      continue;
    }
    vec4 map = texelFetch(lights_tx, ivec2(at + 4, row), 0);
    vec2 texel = floor((place * 0.5 + 0.5) * map.zw);
    vec2 center = (texel + 0.5) / map.zw * 2.0 - 1.0;
    float stored = texelFetch(maps_tx, ivec2(map.xy + texel), 0).x;
    if (stored >= 1.0) {
      return false;
    }
    float near = across.w, far = up.w;
    float hider = parallel ? near + stored * (far - near) :
                             near * far / (far - stored * (far - near));
    // Where the ray through the texel's middle meets the plane of the triangle.
    vec3 ray = parallel ? along.xyz : along.xyz + center.x * across.xyz + center.y * up.xyz;
    vec3 from = parallel ? offset - center.x * across.xyz - center.y * up.xyz : offset;
    float facing = dot(normal, ray);
    float cosine = abs(facing) / max(length(normal) * length(ray), 1e-20);
    float own = (cosine > 1e-3) ? dot(normal, from) / facing : depth;
    float size = along.w * (parallel ? 1.0 : depth);
    float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 1e-3);
    float bias = size * min(LIGHT_BIAS + LIGHT_SLOPE_BIAS * slope, LIGHT_MOST_BIAS);
    bias += slack / max(cosine, 0.2);
    return hider < own - bias - LIGHT_ROUNDING * max(abs(own), far - near);
  }
  return false;
}

#endif
