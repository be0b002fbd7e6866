"""Peeling the scene into layers, seen by a pinhole at a place on the lens (methods 9).

A layer holds, in every texel, the nearest surface behind the layer before: of all surfaces
(`OCCLUDERS`), of the opaque ones (`OPAQUE`), or only of what is brighter than the threshold
(`HIGHLIGHTS`).

References
----------
Everitt, *Interactive order-independent transparency*, NVIDIA 2001.
"""

from dataclasses import replace

from ..device import state
from . import surface

OCCLUDERS = surface.SurfaceTarget(
    "passes/peel_frag.glsl",
    (("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "front_tx"),),
    defines=("OCCLUDERS",),
    shades=False,
)
OPAQUE = replace(OCCLUDERS, defines=("OCCLUDERS", "OPAQUE_ONLY"))
HIGHLIGHTS = surface.SurfaceTarget(
    "passes/peel_frag.glsl",
    (("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "front_tx"), ("FLOAT_2D", "front_color_tx"), ("FLOAT_2D", "scene_tx")),
    splits=True,
)


def draw_layer(draws, view_buffer, instances, textures, highlights=None, lens=(0.0, 0.0)):
    """Draw one layer into the bound frame buffer.

    Parameters
    ----------
    draws : list of Draw
        Of `surface.build_draws` for one of the targets.
    view_buffer : GPUUniformBuf
        `ViewParams` of the raster.
    instances : GPUTexture
        The instance table.
    textures : sequence of GPUTexture
        As the target's samplers: depth of the layer before, all 0 for the first; for highlights
        also the layer before and the depth of the nearest opaque surface.
    highlights : GPUUniformBuf or None
        `HighlightParams`, for highlights.
    lens : tuple of 2 float
        Place on the lens that the scene is seen from, m.
    """
    state.opaque()
    names = ("front_tx", "front_color_tx", "scene_tx")
    bindings = tuple(zip(names[: len(textures)], textures, strict=True))
    sample = (*lens, 0.0, 0.0)
    surface.draw_sample(draws, view_buffer, instances, sample, 0, bindings, highlights)
