// How the discs of highlights are drawn.
struct SplatParams {
  vec4 opening;         // x: anamorphic ratio; y: side of the square that blurs as the pixel filter
                        // does, px; z: how far the opening reaches in units of its radius; w: regions
                        // of the lens along its width that sources stand for
  vec4 rows;            // of the profile: x: w of the first row; y: 1 / (w of the last - of the first);
                        // z: c0, px; w: strength
  vec4 field;           // x: 1 / largest tangent of the tables over the field; y: number of rims, of a
                        // lens with cylinders as x, along y;
                        // z: rows of the light that rims leave; w unused
  vec4 rims[4];         // x: radius; y: shift for a tangent of 1; z: members; w unused
  vec4 wavelength;      // rgb: its weights; w: 1 / focus distance, 1/m
  vec4 dispersion;      // of a band of wavelengths: x: change of the focal length; y: lateral strength;
                        // zw: width over which they vary
  vec4 spread;          // x, y: by how far, px, colours part at least and less than where the band is
                        // drawn; z, w: that is z times what the axial map leaves plus w times the
                        // lateral map's value and the distance from the axis
};
