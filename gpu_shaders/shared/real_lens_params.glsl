// A real lens over one picture: what its tables of displacements cover.
struct RealLensParams {
  vec4 grid;            // xy: field of the first node; zw: 1 / extent of the nodes, x and y
  vec4 table;           // columns and rows of a sample's nodes; z: samples one above the other; w unused
  vec4 vergence;        // x: 1 / the largest of the table, m; y: of the focus, 1/m;
                        // z: 1 / (the largest less that of the focus), m; w unused
  vec4 raster;          // from pixels of the region to the field: scale (xy) and offset (zw)
  vec4 light;           // columns and rows of a table of light; zw unused
};
