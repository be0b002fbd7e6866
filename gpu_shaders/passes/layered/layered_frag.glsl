// One lens sample of a picture that is kept as depth layers: from each pixel a ray goes to the sample's
// place on the lens, and meets the layers front to back. In the raster and its depth buffer's values
// the ray of a thin lens is a straight line, so that each layer is a height field over its texels; a real
// lens bends it.
// Inputs: colors_tx, depths_tx (the layers), means_tx, ranges_tx (their pyramids, in an atlas);
// MATTES: mattes_tx; behind_tx (what surrounds the scene, of one texel where it is one colour);
// places_tx (row: one of 16 sets of places on the lens, m; column: sample; what is beyond the last
// column follows in the next 16 rows), sample_index; offset (of the sample in its pixel, texels);
// layered_buf; sweep (texels of the sample's raster a metre).
// EYES: colours as they are seen from the middle of the lens, and from four places round it.
// CHROMATIC: as in surface_vert, and gain (of the sweep, by 1 / focus distance).
// REAL_LENS: as in surface_vert, and lens_sets (tables of the sample from lens_slot on: one, or one a set).
// Outputs: the sample's colour, premultiplied; MATTES: what the first surface met has; the depth
// buffer's value of the first surface that hides what is behind it.
// COUNTED: instead, how many layers there were to look into (x), how many were looked into (y), and
// how often a depth was read on the way of a ray (z).
// Source: methods 7 (LES09 sections 4 and 5).
#include "lib/hash_lib.glsl"
#include "lib/lens_sets_lib.glsl"
#include "lib/pyramid_atlas_lib.glsl"
#include "lib/bokeh/sweep_lib.glsl"
#ifdef CHROMATIC
#include "lib/chromatic_lib.glsl"
#endif
#include "passes/layered/layer_ray.glsl"

// A texel without a surface.
#define EMPTY 1.5
// Least share of the light that is followed further.
#define LEAST_THROUGH 0.002
// Depth reads along a ray's way through a layer; then the bracket is narrowed by false position. Layers
// that are no slices reach over all depths.
#define MOST_STEPS 24
#define MOST_STEPS_UNORDERED 96
#define FALSE_POSITIONS 3
#define GOLDEN 0.6180339887
// A surface is met where its texels part by no more than this on the ray's way, in texels.
#define SURFACE_STRETCH 1.0
// Texels show one surface to a part of the lens if they move alike across it, in texels.
#define MOVES_ALIKE 1.0

ivec2 size;
int reads = 0, layers;
bool unordered;
#ifdef EYES
// Where the sample is on the lens, as a share of the way to the places that colours are seen from.
vec2 seen_from;
#endif

ivec2 texel_at(vec2 place)
{
  return clamp(ivec2(floor(place)), ivec2(0), size - 1);
}

// Which texels that a surface has a part of it fills, for this ray: those with at least that share. In
// every second layer it is one less it, so that of a surface that one layer has a part of and the next the
// rest no ray misses both.
float least_share;

float depth_at(vec2 place, int layer)
{
  reads++;
  // What is empty lies far behind everything.
  vec2 found = texelFetch(depths_tx, ivec3(texel_at(place), layer), 0).xy;
  float least = ((layer & 1) == 1 && !unordered) ? 1.0 - least_share : least_share;
  return (found.x > EMPTY || found.y < least) ? 4.0 : found.x;
}

// A texel of a level of a layer's pyramid; level 0 is the layer.
vec4 range_of(ivec2 square, int level, int layer)
{
  if (level == 0) {
    float depth = texelFetch(depths_tx, ivec3(square, layer), 0).x;
    return (depth < EMPTY) ? vec4(depth, depth, depth, 1.0) : vec4(2.0, -1.0, 2.0, 0.0);
  }
  return texelFetch(ranges_tx, ivec3(level_origin(size, level) + square, layer), 0);
}

// Least and largest depth over the texels that a part of the ray passes, and what shares squares of at
// least a level.
vec2 depths_between(vec2 between, int layer, int least_level)
{
  vec2 a, b;
  ray_bounds(between, a, b);
  ivec2 low = texel_at(a), high = texel_at(b);
  int span = max(high.x - low.x, high.y - low.y);
  int level = clamp(span == 0 ? 0 : findMSB(span) + 1, least_level, int(layered_buf.sampling.y));
  ivec2 c = low >> level, d = high >> level;
  // The last level is one square.
  vec2 range = range_of(c, level, layer).xy;
  if (d != c) {
    vec4 e = range_of(d, level, layer);
    vec4 f = range_of(ivec2(d.x, c.y), level, layer), g = range_of(ivec2(c.x, d.y), level, layer);
    range = vec2(min(min(range.x, e.x), min(f.x, g.x)), max(max(range.y, e.y), max(f.y, g.y)));
  }
  return range;
}

// A surface that a ray meets in a layer.
struct Hit {
  vec2 place;
  float depth;
  bool found;
};

// Whether a ray is in front of a layer's surface by more than half a texel of its way, or over nothing:
// `ahead` is the surface's depth less the ray's.
bool in_front(float ahead, float pace)
{
  return ahead > EMPTY || ahead * pace > 0.5;
}

// Where the ray is on its way from one depth to another.
#ifdef REAL_LENS
#define ON_WAY(part) ray_place(between.x + extent * (part))
#else
#define ON_WAY(part) (from + way * (part))
#endif

// The first crossing of a thin ray with a layer's height field, between two depths.
Hit meet(vec2 between, int layer)
{
  float extent = between.y - between.x;
#ifdef REAL_LENS
  vec2 low, high;
  ray_bounds(between, low, high);
  float texels = max(high.x - low.x, high.y - low.y);
#else
  vec2 from = ray_place(between.x), way = ray_place(between.y) - from;
  float texels = max(abs(way.x), abs(way.y));
#endif
  int steps = clamp(int(ceil(texels)), 1, unordered ? MOST_STEPS_UNORDERED : MOST_STEPS);
  float pace = pace_at(0.5 * (between.x + between.y));
  float stretch = max(SURFACE_STRETCH, texels / float(steps * (1 << FALSE_POSITIONS)));
  Hit hit = Hit(vec2(0.0), between.x, false);
  float before = 1.0, at_before = 0.0;
  for (int i = 0; i <= steps; i++) {
    // On to the first place that is not in front of the surface: what follows is for few of the steps.
    float at, ahead;
    for (; i <= steps; i++) {
      at = float(i) / float(steps);
      ahead = depth_at(ON_WAY(at), layer) - (between.x + extent * at);
      if (!in_front(ahead, pace)) {
        break;
      }
      before = ahead;
      at_before = at;
    }
    if (i > steps) {
      break;
    }
    bool bracketed = i > 0 && in_front(before, pace);
    if (bracketed) {
      // False position between a place in front of the surface and one behind it.
      float low = at_before, high = at, f_low = before, f_high = ahead;
      for (int j = 0; j < FALSE_POSITIONS && abs(f_high) * pace > 0.5; j++) {
        // Where the one in front is over nothing, the secant says nothing.
        float part = (f_low > EMPTY) ? 0.5 : clamp(f_low / (f_low - f_high), 0.1, 0.9);
        float middle = mix(low, high, part);
        float f = depth_at(ON_WAY(middle), layer) - (between.x + extent * middle);
        if (in_front(f, pace)) {
          low = middle;
          f_low = f;
        }
        else {
          high = middle;
          f_high = f;
        }
      }
      at = high;
      ahead = f_high;
    }
    if (-ahead * pace <= stretch) {
      return Hit(ON_WAY(at), between.x + extent * at + ahead, true);
    }
    // It has passed behind the edge of something nearer, and goes on there.
    before = ahead;
    at_before = float(i) / float(steps);
  }
  return hit;
}

// Bilinear mix of four texels of a level of the atlas.
vec4 mean_of(sampler2DArray atlas, vec2 place, int level, int layer)
{
  ivec2 last = level_size(size, level) - 1, origin = level_origin(size, level);
  vec2 at = place / float(1 << level) - 0.5;
  ivec2 low = clamp(ivec2(floor(at)), ivec2(0), last), high = min(low + 1, last);
  vec2 part = clamp(at - vec2(low), 0.0, 1.0);
  low += origin;
  high += origin;
  vec4 a = texelFetch(atlas, ivec3(low, layer), 0);
  vec4 b = texelFetch(atlas, ivec3(high.x, low.y, layer), 0);
  vec4 c = texelFetch(atlas, ivec3(low.x, high.y, layer), 0);
  vec4 d = texelFetch(atlas, ivec3(high, layer), 0);
  return mix(mix(a, b, part.x), mix(c, d, part.x), part.y);
}

// A colour as this sample sees it, of those in a layer from all eyes: along each axis of the lens the
// parabola through the colours from three of them.
#ifdef EYES
#define ALONG(x, middle, right, left) \
  ((x) * (0.5 * ((right) - (left)) + (x) * (0.5 * ((right) + (left)) - (middle))))
#define SEEN(color_of, layer) \
  parabolas(color_of(layer), \
            color_of(layer + layers), \
            color_of(layer + 2 * layers), \
            color_of(layer + 3 * layers), \
            color_of(layer + 4 * layers))

vec4 parabolas(vec4 middle, vec4 right, vec4 left, vec4 up, vec4 down)
{
  vec4 color = middle + ALONG(seen_from.x, middle, right, left) + ALONG(seen_from.y, middle, up, down);
  return max(color, vec4(0.0));
}
#else
#define SEEN(color_of, layer) color_of(layer)
#endif

// A layer's colour round a place, and how much of the texel has a surface.
vec4 color_at(vec2 place, int layer, out float covered)
{
  if (layered_buf.sampling.z < 0.5) {
    covered = 1.0;
#define TEXEL(slice) texelFetch(colors_tx, ivec3(texel_at(place), slice), 0)
    return SEEN(TEXEL, layer);
  }
  vec2 at = place - 0.5;
  ivec2 low = clamp(ivec2(floor(at)), ivec2(0), size - 1), high = min(low + 1, size - 1);
  vec2 part = clamp(at - vec2(low), 0.0, 1.0);
  vec4 color = mix(mix(texelFetch(colors_tx, ivec3(low, layer), 0),
                       texelFetch(colors_tx, ivec3(high.x, low.y, layer), 0),
                       part.x),
                   mix(texelFetch(colors_tx, ivec3(low.x, high.y, layer), 0),
                       texelFetch(colors_tx, ivec3(high, layer), 0),
                       part.x),
                   part.y);
  covered = clamp(color.a, 0.0, 1.0);
  return color;
}

// The colour of a surface over the part of it that a ray's part of the lens brings to the pixel, and
// how much of a texel it covers. A ray is as thick as the way to its neighbours, half of it on each side;
// the mean is that of what is covered, over squares of texels whose surface moves alike across the ray's
// part. What is covered is decided by the thin ray: the front and the back of a body lie in several layers
// with one outline, whose blurred coverages would add up to a wider body.
vec4 cone_color(Hit hit, int layer, vec2 wide, out float covered)
{
  vec4 light = color_at(hit.place, layer, covered);
  float diameter = abs(wide.x + wide.y * hit.depth);
  int level = min(int(floor(log2(max(diameter, 1.0)) + 0.5)), int(layered_buf.sampling.y));
  for (; level > 0; level--) {
    vec4 range = range_of(texel_at(hit.place) >> level, level, layer);
    if ((range.y - range.x) * abs(wide.y) <= MOVES_ALIKE) {
      break;
    }
  }
  if (level > 0) {
    float share = mean_of(ranges_tx, hit.place, level, layer).w;
#define MEAN(slice) mean_of(means_tx, hit.place, level, slice)
    light = SEEN(MEAN, layer) * (covered / max(share, 1e-6));
  }
  return light;
}

// Narrows the depths that the ray may meet a layer between; whether there are any.
bool narrow(inout vec2 between, int layer, int least_level)
{
  vec2 seen = depths_between(between, layer, least_level);
  vec2 narrowed = vec2(max(between.x, seen.x), min(between.y, seen.y));
  bool possible = narrowed.x <= narrowed.y;
  between = possible ? narrowed : between;
  return possible;
}

// The next layer that the ray may meet nearer than `farthest`, and the depths between which; whether there
// is one. Whoever looks for it in a loop of its own looks into a layer as often as the ray of its
// neighbours that does so most often: where what is not to be done is done all the same and thrown away,
// that is far less.
bool next_layer(inout int layer, float farthest, out vec2 between, out bool possible)
{
  // The last level of a layer's pyramid is one square.
  ivec2 whole = level_origin(size, int(layered_buf.sampling.y));
  possible = false;
  for (layer++; layer < layers; layer++) {
    between = texelFetch(ranges_tx, ivec3(whole, layer), 0).xy;
    between.y = min(between.y, farthest);
    possible = narrow(between, layer, 1);
    if (possible || culls == 0) {
      return true;
    }
  }
  return false;
}

// What the ray has met: light, what is left of it, the first depth that hides what is behind.
vec4 color = vec4(0.0);
float through = 1.0, first = 1.0;
bool met = false;

void add_surface(Hit hit, int layer, vec2 wide)
{
  float covered;
  vec4 light = cone_color(hit, layer, wide, covered);
  color += through * light;
  through *= 1.0 - covered;
  first = (covered > 0.5) ? min(first, hit.depth) : first;
#ifdef MATTES
  if (!met) {
    out_mattes = texelFetch(mattes_tx, ivec3(texel_at(hit.place), layer), 0);
  }
#endif
  met = true;
}

void main()
{
  size = textureSize(depths_tx, 0).xy;
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  int set = lens_set(pixel);
  int across = textureSize(places_tx, 0).x;
  ivec2 entry = ivec2(sample_index % across, set + SETS * (sample_index / across));
  vec2 lens = texelFetch(places_tx, entry, 0).xy;
  vec2 fine = layered_buf.raster.xy;
  vec2 place = gl_FragCoord.xy + offset;
  vec4 moves = sweep;
  vec2 axis = vec2(0.0);
  float scale = 1.0;
#ifdef CHROMATIC
  vec2 field = place * chromatic_buf.raster.xy + chromatic_buf.raster.zw;
  vec2 strengths = field_strengths(field_tx, field, chromatic_buf);
  moves += gain * chromatic_focus(dispersion.x, strengths.x, chromatic_buf);
  scale = lateral_scale(dispersion.y, strengths.y, chromatic_buf);
  axis = -chromatic_buf.raster.zw / chromatic_buf.raster.xy;
#endif
  ray_start = (axis + (place - axis - lens * moves.xy) / scale) * fine + layered_buf.raster.zw;
  ray_along = lens * moves.zw / scale * fine;
#ifdef REAL_LENS
  bend_ray(place, axis, lens, moves, scale, lens_slot + (lens_sets > 1 ? set : 0));
#endif
  // Texels that a ray's part of the lens moves a surface by: constant, and by the depth.
  vec2 wide = layered_buf.sampling.w * max(fine.x, fine.y) * vec2(moves.x, moves.z);
#ifdef MATTES
  out_mattes = vec4(0.0, 0.0, 0.0, empty_focus);
#endif
  int looked = 0, nearest_layer = -1;
  layers = int(layered_buf.sampling.x);
  unordered = layered_buf.eyes.z > 0.5;
#ifdef EYES
  seen_from = lens * layered_buf.eyes.xy;
#endif
  // Golden section steps from sample to sample, from another place in every pixel.
  least_share = fract(hash_unit(hash_combine(uint(pixel.x), uint(pixel.y))) + GOLDEN * float(sample_index));
  Hit nearest = Hit(vec2(0.0), EMPTY, false);
  int layer = -1;
  vec2 between;
  bool possible;
  while (through > LEAST_THROUGH && next_layer(layer, nearest.depth, between, possible)) {
    // Asked again, for the part of the ray that is left, it is often none.
    if (possible && !narrow(between, layer, 0) && culls == 1) {
      continue;
    }
    looked++;
    Hit hit = meet(between, layer);
    if (!hit.found) {
      continue;
    }
    if (!unordered) {
      add_surface(hit, layer, wide);
    }
    else if (nearest_layer < 0 || hit.depth < nearest.depth) {
      // Whatever layer it is in, the nearest surface is seen.
      nearest = hit;
      nearest_layer = layer;
    }
  }
  if (nearest_layer >= 0) {
    add_surface(nearest, nearest_layer, wide);
  }
#ifdef COUNTED
  out_color = vec4(float(layers), float(looked), float(reads), 1.0);
#else
  ivec2 last = textureSize(behind_tx, 0) - 1;
  vec4 behind = (last == ivec2(0)) ? layered_buf.surroundings :
                                     texelFetch(behind_tx, min(pixel, last), 0);
  out_color = color + through * behind;
#endif
  gl_FragDepth = first;
}
