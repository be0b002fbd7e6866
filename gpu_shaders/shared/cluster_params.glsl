// How similar highlights are merged.
struct ClusterParams {
  mat4 world;           // camera to world space; cells that are longer along the axis: shrunk along it
  vec4 lens;            // as in ViewParams: x: focus distance, m; y: 1 for an orthographic camera;
                        // z: scale of the circle of confusion, px; w unused
  vec4 cell;            // x: side of a cell of level 0 in radii of the circle of confusion; y: side
                        // of a pixel 1 m away (orthographic: anywhere), m; zw unused
  vec4 limits;          // x: extent of what is merged in radii of the circle of confusion, at most;
                        // y: harm (see cluster_lib) that a merge may do; z: last level that global
                        // merges compare with; w unused
};
