// Radial tiling: the plane around a point in as many segments as a polygon has sides. Between sharp and
// round **ours**: corners are arcs; Blender's are a little blunter.
#ifndef TILING_LIB_GLSL
#define TILING_LIB_GLSL

#define TILING_TURN 6.28318530718

struct Tiling {
  vec2 place;  // across the segment, and outwards
  float id;
  float width;     // half of the segment's side, at the polygon of apothem 1
  float rotation;  // of the segment's middle, radians
};

// Half the length of a side, whose half angle is `half_angle`: a fit to what Cycles gives.
float tiling_width(float half_angle, float roundness)
{
  float a2 = half_angle * half_angle;
  float power = 3.0 - a2 * (0.97 - 0.57 * roundness);
  return half_angle + (tan(half_angle) - half_angle) * pow(max(1.0 - roundness, 0.0), power);
}

Tiling radial_tiling(vec2 place, float sides, float roundness, bool normalizes)
{
  float count = max(sides, 2.0), r = clamp(roundness, 0.0, 1.0);
  float whole = TILING_TURN / count;
  float angle = (place == vec2(0.0)) ? 0.0 : atan(place.y, place.x);
  angle = (angle < 0.0) ? angle + TILING_TURN : angle;
  Tiling tiling;
  tiling.id = floor(angle / whole);
  // A number of sides that is not whole leaves a smaller segment at the end.
  float size = min(whole, TILING_TURN - tiling.id * whole);
  tiling.rotation = tiling.id * whole + 0.5 * size;
  float half_angle = min(0.5 * size, 1.5533);
  vec2 axis = vec2(cos(tiling.rotation), sin(tiling.rotation));
  // All corners lie on one circle: the side of a smaller segment is further away.
  float nearer = cos(min(0.5 * whole, 1.5533)) / cos(half_angle);
  vec2 p = nearer * vec2(dot(place, vec2(-axis.y, axis.x)), dot(place, axis));
  tiling.width = tiling_width(half_angle, r) * ((r < 1.0) ? 1.0 : nearer);
  float start = half_angle * (1.0 - r), across = abs(p.x);
  // The polygon through the place is this many times as large as that of apothem 1.
  float scale = p.y, along = across;
  if (r > 0.0 && across > p.y * tan(start)) {
    float t = tan(start), radius = 1.0 - t / tan(half_angle);
    vec2 center = vec2(t, 1.0 - radius);
    // The circle's middle and radius grow with it.
    float a = dot(center, center) - radius * radius, b = dot(vec2(across, p.y), center);
    float c = dot(p, p);
    scale = (abs(a) < 1e-6) ? c / (2.0 * b) : (b - sqrt(max(b * b - a * c, 0.0))) / a;
    vec2 spoke = vec2(across, p.y) - scale * center;
    along = scale * (t + (tiling.width - t) * atan(spoke.x, spoke.y) / half_angle);
  }
  // Of circles Blender tells the angle across.
  float x = (r < 1.0) ? along : nearer * atan(across, p.y);
  x = (p.x < 0.0) ? -x : x;
  tiling.place = vec2(x, scale - 1.0);
  if (normalizes) {
    float span = ((r < 1.0) ? scale : 1.0) * tiling.width;
    tiling.place = vec2((span != 0.0) ? 0.5 * x / span + 0.5 : 0.0, scale);
  }
  return tiling;
}

#endif
