// A source (highlight or cluster of highlights) for the tests of its visibility.
#ifndef SOURCE_LIB_GLSL
#define SOURCE_LIB_GLSL
#include "lib/lens_lib.glsl"
#include "lib/bokeh/visibility_lib.glsl"

// States of a source that the tests write.
#define STATE_OUTSIDE 1.0  // the disc does not meet the frame
#define STATE_HIDDEN 2.0   // hidden from the whole lens
#define STATE_VISIBLE 3.0  // no surface of the peeled layers lies in front of it
#define STATE_OPEN 4.0     // not decided
#define STATE_FREE 5.0     // no triangles in the cone to the lens
#define STATE_EDGE 6.0     // as STATE_VISIBLE, unless a surface outside the raster lies in front

struct Source {
  Cone cone;
  vec2 place;   // in the peeled raster, texels
  float coc;    // radius of the disc at the wavelength where it is largest, px
  float depth;  // depth buffer value
  float hides;  // depth from which on, towards the lens, surfaces hide it, m
  float limit;  // the same as depth buffer value
};

ivec2 list_texel(int index)
{
  return ivec2(index % SOURCE_COLUMNS, index / SOURCE_COLUMNS);
}

float largest_coc(float depth, VisibilityParams params)
{
  vec2 change = params.colors.xy * (params.lens.z * ((params.lens.y > 0.5) ? depth : 1.0));
  vec2 coc = abs(coc_radius_px(depth, params.lens) + change);
  return max(coc.x, coc.y);
}

// `a`: texel of the list, x, y, depth (m) and extent (px).
Source source_of(vec4 a, VisibilityParams params)
{
  Source source;
  bool orthographic = params.lens.y > 0.5;
  source.cone = source_cone(a.xyz, params.lens);
  vec4 clip = params.projection * vec4(a.xy, -a.z, 1.0);
  source.place = (clip.xy / clip.w * 0.5 + 0.5) * params.raster.xy;
  source.coc = largest_coc(a.z, params);
  source.depth = window_depth(a.z, params.sweep, orthographic);
  source.hides = hiding_depth(a.z, params.lens, params.raster.w);
  source.limit = window_depth(source.hides, params.sweep, orthographic);
  return source;
}

// Texels that the line to the rim of the opening moves for each unit of the depth buffer.
vec2 source_reach(VisibilityParams params)
{
  return params.sweep.xy * params.opening.xy;
}

// Class of size of a source's mask.
int source_class(float coc, VisibilityParams params)
{
  float side = 2.0 * coc * params.tiles.z / params.tiles.y;
  return clamp(int(ceil(log2(max(side, 1.0)))), 0, int(params.tiles.x) - 1);
}

#endif
