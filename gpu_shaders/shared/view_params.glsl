// The camera of one frame: the same for all its lens samples.
struct ViewParams {
  mat4 view;            // world to camera space (x right, y up, looking along -z)
  mat4 view_inverse;    // camera to world space
  mat4 projection;      // camera space to clip space of the rendered region
  vec4 lens;            // x: focus distance, m; y: 1 for an orthographic camera;
                        // z: scale of the circle of confusion, px; w: radius that is sharp, px
  vec4 film;            // xy: size of a lens sample's raster, texels; zw: its place in the picture, px
};
