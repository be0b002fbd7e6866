// Energy density of each highlight's disc, before its splat: a thread for each, where the corners of
// its square would each find the same.
// Inputs: as of splat_vert but pos and density_tx; discs (how many); besides, REAL_LENS: light_tx (light of the
// picture over that of an even one), area_tx (how much larger surfaces are seen).
// Outputs: density_img: for each source what the shape of its disc is multiplied by.
// Source: methods 13.

// What the splat has as varyings.
vec4 v_tile;
float v_blur;
float v_region;
float v_row;
float v_tile_up;
float v_upright;
float v_dot;
vec2 v_chief;
vec2 v_tile_at;
vec3 v_area;
vec3 v_left_lower;
vec3 v_left_upper;

#include "lib/bokeh/splat_disc_lib.glsl"
#ifdef REAL_LENS
#include "lib/light_table_lib.glsl"
#endif

#ifdef CHROMATIC

// Pixels on either side of a dot's centre over which its light is summed.
#define TENT_PIXELS 6

// Sums over the pixels along each axis of tents of these half widths, px: nearly the half widths, but
// the difference is the same for all pixels of a bright surface in focus and would show.
vec2 tent_sum(vec2 center, vec2 tent)
{
  if (max(tent.x, tent.y) > float(TENT_PIXELS - 1)) {
    return tent;
  }
  vec2 phase = fract(center - 0.5);
  vec2 sum = vec2(0.0);
  for (int i = -TENT_PIXELS; i <= TENT_PIXELS; i++) {
    sum += max(1.0 - abs(float(i) - phase) / tent, vec2(0.0));
  }
  return sum;
}

#endif

// Discs up to this radius, px, are brought to their energy on the grid of pixels.
#define GRID_RADIUS 5.0
// The same for a source that stands for a region of the lens, px for each region along the opening's
// width: sources of one view all have the same place among the pixels, and their errors add up.
#define GRID_RADIUS_REGION 3.5
// Places along the width of a disc from which the share of a region is found.
#define REGION_PLACES 16
// Least part of a disc's energy that a grid may show: a disc that is thinner than a pixel may lie
// between its pixels.
#define GRID_LEAST 0.25

// Sum of the light of the source's region over pixel centres, whose places on the opening are
// `origin + axes * offset`, with the offset from the disc's centre, px; `reach` in px.
vec3 grid_sum(vec2 center, vec2 origin, mat2 axes, float reach)
{
  vec3 sum = vec3(0.0);
  vec2 lens;
  vec2 low = ceil(center - reach - 0.5) + 0.5;
  int count = int(2.0 * reach) + 1;
  for (int i = 0; i < count * count; i++) {
    vec2 offset = low + vec2(i % count, i / count) - center;
    vec3 density = disc_density(origin + axes * offset, lens);
    sum += density * region_weight(lens);
  }
  return sum;
}

// Share of the disc's light that belongs to the source's region; as grid_sum.
vec3 region_share(vec2 origin, mat2 axes, float reach)
{
  if (v_region < 0.5) {
    return vec3(1.0);
  }
  vec3 all = vec3(0.0), own = vec3(0.0);
  vec2 lens;
  for (int i = 0; i < REGION_PLACES * REGION_PLACES; i++) {
    vec2 place = (vec2(i % REGION_PLACES, i / REGION_PLACES) + 0.5) / float(REGION_PLACES);
    vec3 density = disc_density(origin + axes * ((place * 2.0 - 1.0) * reach), lens);
    all += density;
    own += density * region_weight(lens);
  }
  return own / max(all, vec3(1e-30));
}

void main()
{
  int index = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * int(gl_WorkGroupSize.x) +
              int(gl_LocalInvocationID.x);
  if (index >= discs) {
    return;
  }
  ivec2 texel = ivec2(index % SOURCE_COLUMNS, index / SOURCE_COLUMNS);
  vec4 a = texelFetch(sources_a_tx, texel, 0);
  vec4 b = texelFetch(sources_b_tx, texel, 0);
  v_tile = texelFetch(tiles_tx, texel, 0);
  SplatDisc disc = splat_disc(a, b);
  if (!disc.drawn) {
    imageStore(density_img, texel, vec4(0.0));
    return;
  }
  vec3 density = b.rgb * splat_buf.wavelength.rgb * disc.share;
#ifdef CHROMATIC
  if (disc.is_dot) {
    vec2 sum = tent_sum(disc.center, disc.tent);
    density = b.rgb * splat_buf.wavelength.rgb / max(sum.x * sum.y, 1e-6);
    // No place of a dot is that of a region of the lens.
    density *= region_share(vec2(0.0), mat2(1.0), 1.0);
  }
#endif
  float from_grid = (v_region < 0.5) ? GRID_RADIUS : GRID_RADIUS_REGION * splat_buf.opening.w;
  if (disc.widest < max(from_grid, GRID_RADIUS) && !disc.is_dot) {
    // What the sum is where pixels are small.
    vec3 whole = abs(1.0 / determinant(disc.axes)) *
                 region_share(disc.origin, disc.axes, disc.farthest);
    vec3 sum = grid_sum(disc.center, disc.origin, disc.axes, disc.farthest);
    density *= whole / max(sum, GRID_LEAST * whole + 1e-30);
  }
#ifdef REAL_LENS
  vec4 table = vec4(real_lens_buf.light.xy, 1.0, 0.0);
  density *= light_at(light_tx, disc.center / view_buf.film.xy, table).x *
             real_lens_area(area_tx, vec3(a.xy, -a.z), real_lens_buf);
#endif
  imageStore(density_img, texel, vec4(density, 0.0));
}
