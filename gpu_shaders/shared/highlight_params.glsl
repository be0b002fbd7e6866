// The highlight threshold: what is splatted as bokeh instead of being blurred by lens samples.
struct HighlightParams {
  vec4 split;           // x: threshold, the least one where it is automatic; y: least circle of confusion, px; z: gain of what is
                        // splatted; w: circle of confusion of what is infinitely far, px
  vec4 world;           // x: depth that stands for infinity, m; y: 1 if the world gives highlights;
                        // z: share of its light above the threshold that is splatted; w unused
  mat4 raster;          // camera space to clip space of the raster that highlights are searched in
  vec4 views;           // xy: reach of the lens' opening across and up, m; z: places on the lens that
                        // mirroring surfaces are searched from, across and up; w unused
  vec4 automatic;       // x: how many times brighter than its surroundings a highlight is, 0: the
                        // threshold is not automatic; y: last level of the pyramid of surroundings;
                        // zw: tiles of the raster across and up
  vec4 size;            // xy: of the raster, px; zw: of each half of surroundings_tx
};
