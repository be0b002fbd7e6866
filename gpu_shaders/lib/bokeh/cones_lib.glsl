// The cone from a source to the lens, tested against boxes and triangles
// (passes/visibility/bokeh_cones*_comp).
//
// Seen from the source, a place is projected onto the lens: homogeneous coordinates x, y and w, in
// units of half the opening, are linear in the place (see lib/bokeh/visibility_lib.glsl). In them, the cone
// is the circle |xy| <= R w, cut off where w is too small (beyond what can hide the source) and too
// large (before the clip start).
#ifndef CONES_LIB_GLSL
#define CONES_LIB_GLSL
#include "lib/bokeh/occluder_blur_lib.glsl"

// Bound of the rounding error of a coordinate, as a share of the terms of its sum.
#define CONE_ROUNDING 1e-6

struct LensView {
  vec4 x;       // rows of the projection
  vec4 y;
  vec4 w;
  float reach;  // R
  vec2 range;   // of w
  vec3 slack;   // of x, y and w, for rounding
};

// In camera space. `farthest`: depth beyond which nothing counts, m.
LensView lens_view_of(Source source, float farthest, VisibilityParams params)
{
  Cone cone = source.cone;
  LensView view;
  view.x = vec4(1.0, 0.0, cone.b.x, -cone.a.x) / params.opening.x;
  view.y = vec4(0.0, 1.0, cone.b.y, -cone.a.y) / params.opening.y;
  view.w = vec4(0.0, 0.0, 1.0, cone.depth) * cone.rate;
  // A mask is blurred when it is read: occluders up to 1.5 texels beyond the rim count, diagonally too.
  float side = params.tiles.y * exp2(float(source_class(source.coc, params)));
  view.reach = 1.0 + 4.3 / side;
  view.range = (cone.depth - vec2(farthest, params.opening.z)) * cone.rate;
  view.slack = vec3(0.0);
  return view;
}

// In a space from which `matrix` leads to its own; `far`: largest coordinates there.
LensView lens_view_in(LensView view, mat4 matrix, vec3 far)
{
  view.x = view.x * matrix;
  view.y = view.y * matrix;
  view.w = view.w * matrix;
  view.slack = CONE_ROUNDING * vec3(dot(abs(view.x), vec4(far, 1.0)),
                                    dot(abs(view.y), vec4(far, 1.0)),
                                    dot(abs(view.w), vec4(far, 1.0)));
  return view;
}

vec3 lens_place(LensView view, vec3 place)
{
  return vec3(dot(view.x.xyz, place) + view.x.w,
              dot(view.y.xyz, place) + view.y.w,
              dot(view.w.xyz, place) + view.w.w);
}

// Whether a box may meet the cone.
bool meets_box(LensView view, vec3 low, vec3 high)
{
  vec3 half_size = 0.5 * (high - low);
  vec3 center = lens_place(view, 0.5 * (low + high));
  float thick = dot(abs(view.w.xyz), half_size) + view.slack.z;
  if (center.z + thick < view.range.x || center.z - thick > view.range.y) {
    return false;
  }
  // Two pairs of planes round the circle.
  vec3 w = view.reach * view.w.xyz;
  float side = view.reach * (center.z + view.slack.z);
  vec2 more = vec2(dot(abs(w - view.x.xyz), half_size), dot(abs(w - view.y.xyz), half_size));
  vec2 less = vec2(dot(abs(w + view.x.xyz), half_size), dot(abs(w + view.y.xyz), half_size));
  return all(greaterThanEqual(side - center.xy + more + view.slack.xy, vec2(0.0))) &&
         all(greaterThanEqual(side + center.xy + less + view.slack.xy, vec2(0.0)));
}

// Whether the circle lies beyond an edge of a triangle, given by the product of its ends.
bool beyond(LensView view, vec3 edge, float turn)
{
  float most = turn * edge.z + view.reach * length(edge.xy);
  return most < -CONE_ROUNDING * (abs(edge.z) + abs(edge.x) + abs(edge.y));
}

// Whether a triangle may meet the cone.
bool meets_triangle(LensView view, vec3 a, vec3 b, vec3 c)
{
  vec3 p = lens_place(view, a), q = lens_place(view, b), r = lens_place(view, c);
  vec3 w = vec3(p.z, q.z, r.z);
  vec3 outer = view.reach * (w + view.slack.z);
  vec3 x = vec3(p.x, q.x, r.x), y = vec3(p.y, q.y, r.y);
  if (all(lessThan(w, vec3(view.range.x - view.slack.z))) ||
      all(greaterThan(w, vec3(view.range.y + view.slack.z))) ||
      all(greaterThan(x - view.slack.x, outer)) || all(lessThan(x + view.slack.x, -outer)) ||
      all(greaterThan(y - view.slack.y, outer)) || all(lessThan(y + view.slack.y, -outer)))
  {
    return false;
  }
  // Clusters are padded with degenerate triangles (points).
  if (a == b && b == c) {
    return false;
  }
  vec3 qr = cross(q, r), rp = cross(r, p), pq = cross(p, q);
  float turn = dot(p, qr);
  // Seen edge-on: rounding decides its winding.
  if (abs(turn) <= 10.0 * CONE_ROUNDING * dot(abs(p), abs(qr))) {
    return true;
  }
  turn = sign(turn);
  return !(beyond(view, qr, turn) || beyond(view, rp, turn) || beyond(view, pq, turn));
}

// Occluders that a source's cone has met: their number, their largest w, and the weighted sum and the
// weights of the blur that they need where the source is merged (see occluder_blur_lib).
struct Met {
  uint found;
  float most;
  vec2 blur;
};

Met nothing_met()
{
  return Met(0u, 0.0, vec2(0.0));
}

// Notes a box that meets the cone and holds triangles of an `area`, m^2.
void meet(inout Met met,
          LensView view,
          Source source,
          float extent,
          float area,
          vec3 low,
          vec3 high,
          VisibilityParams params)
{
  met.found++;
  float w = dot(view.w.xyz, 0.5 * (low + high)) + view.w.w;
  met.most = max(met.most, w + dot(abs(view.w.xyz), 0.5 * (high - low)));
  w = clamp(w, view.range.x, view.range.y);
  float z = source.cone.depth - w / source.cone.rate;
  float spread = max(params.opening.x * params.opening.y * w * w, 1e-20);
  float weight = min(area / spread, 1.0);
  met.blur += weight * vec2(occluder_blur(source, extent, z, params), 1.0);
}

// Whether a source in this state is not decided yet.
bool state_is_open(float state)
{
  return state == STATE_OPEN || state == STATE_FREE;
}

// Depth beyond which no surface outside the layers' raster can hide the source in the frame, m.
float edge_depth(Source source, VisibilityParams params)
{
  float margin = min(params.frame.x, params.frame.y);
  return source.coc < margin ? min(source.hides, params.tiles.w) : source.hides;
}

// The record of a source after a test. `first`: nothing else was tested before.
vec4 record_after(vec4 record, Met met, Source source, bool first, VisibilityParams params)
{
  if (met.found == 0u) {
    // Free until something meets the cone.
    record.w = (first && record.w == STATE_OPEN) ? STATE_FREE : record.w;
    return record;
  }
  record.w = state_is_open(record.w) ? STATE_OPEN : record.w;
  float nearest = max(source.cone.depth - met.most / source.cone.rate, params.opening.z);
  record.x = min(record.x, window_depth(nearest, params.sweep, params.lens.y > 0.5));
  record.yz += met.blur;
  return record;
}

#endif
