// The depth layers of one frame, for rays of the lens that are cast through them.
struct LayeredParams {
  vec4 surroundings;    // colour where no layer has a surface, premultiplied
  vec4 raster;          // xy: texels of a layer along a side of a texel of the sample; zw: texels of a
                        // layer on the left of and below the sample's raster
  vec4 sampling;        // x: layers; y: levels of their pyramids; z: 1 if colours are filtered between
                        // texels; w: side of the part of the lens that a ray stands for, m; 0: a thin ray
  vec4 eyes;            // xy: one over the distance on the lens of the places that colours are seen from
                        // beside its middle, 1/m; z: 1 if layers lie in no order; w: unused
  vec4 vergence;        // REAL_LENS: x, y: 1 / depth, 1/m, is x + y times the depth buffer's value;
                        // z: that of the nearest surface, the nodes' unit, 1/m; w: unused
  vec4 nodes;           // REAL_LENS: vergences that a ray's bend is looked up for, in that unit
  mat4 powers;          // REAL_LENS: from four bends there to the powers of a cubic
};
