// The source whose cone a thread of bokeh_cones_comp or bokeh_cones_groups_comp tests.
// Inputs: sources_tx; visibility_buf; count; without EDGES keys_img and culls; FILL: states_tx,
// keys_tx, totals_tx, window, otherwise states_img.
// Outputs: keys_img, where nothing is tested.
#include "lib/bokeh/cones_lib.glsl"

struct ConeSource {
  bool tested;
  ivec2 texel;
  ivec2 key;      // of its number of pairs
  uint place;     // FILL: of its first pair
  vec4 record;    // its state
  float side;     // of the square that it stands for, px
  Source source;
  LensView view;  // in camera space
};

#ifdef FILL
// Prefix sum: number of pairs before those of a key; for a key behind the last, more than there are.
uint pairs_before(ivec2 key)
{
  if (key.x == SOURCE_COLUMNS) {
    key = ivec2(0, key.y + 1);
  }
  if (key.y == textureSize(keys_tx, 0).y) {
    return ~0u;
  }
  return texelFetch(keys_tx, key, 0).x + texelFetch(totals_tx, list_texel(key.y), 0).x;
}
#endif

// `segment`: first row of keys.
ConeSource source_of_thread(int index, int segment)
{
  ConeSource own;
  own.texel = list_texel(index);
  own.key = own.texel + ivec2(0, segment);
  own.place = 0u;
  own.record = vec4(0.0);
  own.tested = index < count;
#ifdef FILL
  if (own.tested) {
    own.record = texelFetch(states_tx, own.texel, 0);
    own.place = pairs_before(own.key);
    // A source without pairs in this window need not be tested again.
    bool within = own.place < uint(window.x + window.y) &&
                  pairs_before(own.key + ivec2(1, 0)) > uint(window.x);
    own.tested = within && (state_is_open(own.record.w) || culls == 0);
  }
#else
  if (own.tested) {
    own.record = imageLoad(states_img, own.texel);
  }
#ifdef EDGES
  own.tested = own.tested && own.record.w == STATE_EDGE;
#else
  own.tested = own.tested && (state_is_open(own.record.w) || culls == 0);
  if (!own.tested) {
    imageStore(keys_img, own.key, uvec4(0u));
  }
#endif
#endif
  if (own.tested) {
    vec4 a = texelFetch(sources_tx, own.texel, 0);
    own.side = a.w;
    own.source = source_of(a, visibility_buf);
#ifdef EDGES
    float farthest = edge_depth(own.source, visibility_buf);
#else
    float farthest = own.source.hides;
#endif
    own.view = lens_view_of(own.source, farthest, visibility_buf);
  }
  return own;
}
