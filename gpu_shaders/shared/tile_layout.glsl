// Where the masks of each size lie in the atlas.
struct TileLayout {
  vec4 atlas;           // xy: size, texels; zw unused
  vec4 sizes[12];       // x: masks of other sizes before; y: height of the first row, texels;
                        // z: side, texels; w: masks a row
};
