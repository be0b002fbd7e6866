// Chromatic aberration of one frame: what does not depend on the wavelength.
struct ChromaticParams {
  vec4 field;           // x: 1 / distance of the picture's outermost corner from the axis, as a tangent
                        // (parallel projection: m); y: 1 for a parallel projection; z, w: last column
                        // and number of rows of the field table
  vec4 focus;           // x: 1 / focus distance of the reference wavelength, 1/m; y: 1 / its focal
                        // length, 1/m; z unused; w: least lateral scale
  vec4 raster;          // from pixels of the region to the field: scale (xy) and offset (zw)
  vec4 extremes;        // x, y: least and largest change of the focal length of any wavelength;
                        // z: largest lateral strength; w unused
  vec4 typical;         // x, y: two changes of the focal length, whose circles of confusion have about
                        // the mean square of those of all wavelengths; zw unused
};
