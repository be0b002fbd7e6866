// The highlight threshold: what is splatted as bokeh instead of being blurred by lens samples.
struct HighlightParams {
  vec4 split;           // x: threshold; y: least circle of confusion, px; z: gain of what is
                        // splatted; w unused
  vec4 world;           // x: depth that stands for infinity, m; y: 1 if the world gives highlights;
                        // z: share of its light above the threshold that is splatted; w unused
};
