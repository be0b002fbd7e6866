// What the glass of one instance reads about its surroundings.
struct GlassParams {
  vec4 probe;           // xyz: from where the probe was drawn, world space; w: radius around the glass, m
  vec4 clip;            // near and far plane of the probe's faces, m; texels of a face's side; 0
  vec4 part;            // x, y, right, top of the part of the sample's raster that is drawn, texels
};
