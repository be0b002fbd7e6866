// Chromatic aberration of the thin lens (methods 8): another focus distance (axial) and another
// magnification (lateral) for each wavelength, both varying over the field.
// Source: Jeong, dissertation, section 4.1, equations 4.5, 4.7 and 4.8.
#ifndef CHROMATIC_LIB_GLSL
#define CHROMATIC_LIB_GLSL
#include "lib/lens_lib.glsl"

// No focal length shrinks below this share: it would turn the lens inside out.
#define LEAST_FOCAL_SHARE 0.05

// Strengths of the axial (x) and the lateral (y) aberration at a place of the field: a point of the
// plane at a distance of 1 m from the lens. The table's columns run from the axis to the picture's
// outermost corner; its rows, if there are several, go round the axis in the steps of a diamond,
// which need no arc tangent.
vec2 field_strengths(sampler2D field_tx, vec2 place, ChromaticParams params)
{
  float size = abs(place.x) + abs(place.y);
  float away = min(length(place) * params.field.x, 1.0) * params.field.z;
  int column = min(int(away), int(params.field.z) - 1);
  float along = away - float(column);
  int rows = int(params.field.w);
  if (rows == 1) {
    return mix(texelFetch(field_tx, ivec2(column, 0), 0).xy,
               texelFetch(field_tx, ivec2(column + 1, 0), 0).xy,
               along);
  }
  float side = place.y / max(size, 1e-30);
  float turn = (place.x < 0.0) ? 2.0 - side : (side < 0.0 ? 4.0 + side : side);
  float row = turn * 0.25 * float(rows);
  int lower = min(int(row), rows - 1);
  int upper = (lower + 1 == rows) ? 0 : lower + 1;
  float across = row - float(lower);
  vec2 below = mix(texelFetch(field_tx, ivec2(column, lower), 0).xy,
                   texelFetch(field_tx, ivec2(column + 1, lower), 0).xy,
                   along);
  vec2 above = mix(texelFetch(field_tx, ivec2(column, upper), 0).xy,
                   texelFetch(field_tx, ivec2(column + 1, upper), 0).xy,
                   along);
  return mix(below, above, across);
}

// Where a point of camera space lies in the field; points that are not in front of the camera lie far
// outside.
vec2 field_place(vec3 eye, ChromaticParams params)
{
  return (params.field.y > 0.5) ? eye.xy : eye.xy / max(-eye.z, 1e-9);
}

// One over the focus distance, 1/m, of a wavelength whose focal length differs by `change` relative to
// the reference wavelength's; below 0 beyond infinity. `axial`: value of the axial field map, 0 the whole difference, 1 none.
float chromatic_focus(float change, float axial, ChromaticParams params)
{
  float ratio = max(1.0 + change * (1.0 - axial), LEAST_FOCAL_SHARE);
  return params.focus.x + (1.0 / ratio - 1.0) * params.focus.y;
}

float lateral_scale(float lateral, float strength, ChromaticParams params)
{
  return max(1.0 + lateral * strength, params.focus.w);
}

// Radius of the circle of confusion that represents all wavelengths, px: about the root of their mean
// square. `place` in the field; `lens` as in ViewParams.
float chromatic_coc_px(
    sampler2D field_tx, vec2 place, float depth, vec4 lens, ChromaticParams params)
{
  float axial = field_strengths(field_tx, place, params).x;
  vec2 focus = vec2(chromatic_focus(params.typical.x, axial, params),
                    chromatic_focus(params.typical.y, axial, params));
  vec2 coc = vec2(coc_radius_at(depth, focus.x, lens), coc_radius_at(depth, focus.y, lens));
  return sqrt(0.5 * dot(coc, coc));
}

// As lens_displace, for a wavelength; `dispersion`: change of the focal length, lateral strength.
vec3 chromatic_displace(sampler2D field_tx,
                        vec3 eye,
                        vec2 lens_xy,
                        vec2 dispersion,
                        ChromaticParams params)
{
  vec2 strengths = field_strengths(field_tx, field_place(eye, params), params);
  float focus = chromatic_focus(dispersion.x, strengths.x, params);
  float scale = lateral_scale(dispersion.y, strengths.y, params);
  return vec3(eye.xy * scale - lens_xy * (1.0 + eye.z * focus), eye.z);
}

#endif
