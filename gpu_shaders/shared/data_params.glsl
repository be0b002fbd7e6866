// What the data passes need beside the camera.
struct DataParams {
  mat4 previous;        // world to clip space of the region in the previous frame
  mat4 next;            // the same in the next frame
  vec4 raster;          // xy: pixels in a clip unit; z: opacity below which a surface is left out;
                        // w unused
};
