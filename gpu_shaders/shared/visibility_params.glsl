// How highlights are tested against their occluders.
struct VisibilityParams {
  mat4 view;            // world to camera space
  mat4 projection;      // camera space to clip space of the peeled raster
  vec4 lens;            // as in ViewParams: x: focus distance, m; y: 1 for an orthographic camera;
                        // z: scale of the circle of confusion, px; w: anamorphic ratio
  vec4 opening;         // xy: half width and height of the opening, m; z: clip start, m;
                        // w: how far a disc reaches in units of its radius
  vec4 raster;          // xy: size of the peeled raster, texels; z: texels a pixel;
                        // w: movement in the picture that makes no difference, px
  vec4 frame;           // xy: lower left corner of the frame in the raster, px; zw: its size, px
  vec4 sweep;           // xy: texels that a metre of the lens moves a unit of the depth buffer;
                        // zw: depth buffer value = z + w / depth (orthographic: z + w depth)
  vec4 tiles;           // x: number of sizes of masks; y: smallest size, texels;
                        // z: texels a pixel of the picture; w: depth, m, up to which a surface
                        // outside the raster can reach into the frame
  vec4 colors;          // of wavelengths: x, y: least and largest change of 1 / focus distance, 1/m;
                        // z: share of their way from the axis that discs move by, at the most;
                        // w: focus distance that stands for all, m
  vec4 layers;          // x: 1 if the peeled layers are pictures with partly covered pixels, whose
                        // coverage goes over from texel to texel; yzw unused
};
