"""Peeling the scene into layers, seen by a pinhole at the lens' centre (methods 9).

Layer k holds, in every texel, the surface that k others are in front of: its light above the
threshold, its opacity and its depth.

References
----------
Everitt, *Interactive order-independent transparency*, NVIDIA 2001.
"""

from ..device import state
from . import surface

TARGET = surface.SurfaceTarget(
    "passes/peel_frag.glsl",
    (("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "front_tx"),),
    splits=True,
)


def draw_layer(draws, view_buffer, instances, highlights, front):
    """Draw one layer into the bound frame buffer.

    Parameters
    ----------
    draws : list of Draw
        Of `surface.build_draws` for `TARGET`.
    view_buffer : GPUUniformBuf
        `ViewParams` of the raster.
    instances : GPUTexture
        The instance table.
    highlights : GPUUniformBuf
        `HighlightParams`.
    front : GPUTexture
        Depth of the layer before; all 0 for the first.
    """
    state.opaque()
    bindings = (("front_tx", front),)
    center = (0.0, 0.0, 0.0, 0.0)
    surface.draw_sample(draws, view_buffer, instances, center, 0, bindings, highlights)
