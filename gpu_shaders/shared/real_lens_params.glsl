// A real lens over one picture: what its tables of displacements cover.
struct RealLensParams {
  vec4 grid;            // xy: field of the first node; zw: 1 / extent of the nodes, x and y
  vec4 table;           // columns and rows of a sample's nodes; z: samples one above the other; w unused
  vec4 vergence;        // 1/m: x: 1 / the largest of the table (as m), y: of the focus;
                        // z: 1 / (the largest less that of the focus); w unused
};
