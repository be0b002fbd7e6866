// How far a surface moves in the raster between two places on the lens, from its depth buffer value:
// 1/focus - 1/depth (for a parallel projection depth/focus - 1) is affine in that value.
#ifndef SWEEP_LIB_GLSL
#define SWEEP_LIB_GLSL

// `move`: difference of the places, m; `sweep`: texels a metre, constant (xy) and per unit of the
// depth buffer (zw).
vec2 sweep_px(vec2 move, vec4 sweep, float depth)
{
  return move * (sweep.xy + sweep.zw * depth);
}

#endif
