// The blur of lens samples over the parts of the lens that they stand for: the same for all samples.
struct SubsampleParams {
  vec4 sweep;           // see lib/bokeh/sweep_lib.glsl
  vec4 gain;            // its change by 1 / focus distance, for wavelengths
  vec4 bounds;          // xy: largest offset of any sample along x and y, m; zw: least and largest
                        // value that the depth buffer may have
  vec4 cell;            // x: side of the part of the lens that a ray stands for, m; y: levels of the
                        // pyramid's means that are used, 0 uses none; z: of its depth ranges; w unused
};
