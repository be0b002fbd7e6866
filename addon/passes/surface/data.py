"""The data passes: depth, normal, position, motion and CoC seen by a pinhole (methods 1).

One draw of the scene fills Depth, Normal, Position, Vector and CoC together, from the middle of
each pixel: these values must not be averaged across an edge.
"""

from dataclasses import replace

import numpy as np

from ...device.uniform_block import UniformStruct
from ...device.uniforms import uniform_buffer
from . import surface, surface_target

DATA_PARAMS = UniformStruct("shared/data_params.glsl", "DataParams")

EMPTY_DEPTH = 1e10

# Colour targets by slot, all RGBA32F; the last only where it is asked for.
_GEOMETRY = ("normal_depth", "position_coc", "vector")
_DETAIL = "detail"

# Where each pass lies: target, first channel, channels.
PLACES = {
    "Normal": ("normal_depth", 0, 3),
    "Depth": ("normal_depth", 3, 1),
    "Position": ("position_coc", 0, 3),
    "CoC": ("position_coc", 3, 1),
    "Vector": ("vector", 0, 4),
    "Detail": ("detail", 0, 3),
}

_STILL = surface_target.SurfaceTarget(
    "passes/surface/data_frag.glsl",
    tuple(("VEC4", f"out_{name}") for name in _GEOMETRY),
    attributes=("normal",),
    structs=DATA_PARAMS.source,
    uniforms=(("DataParams", "data_buf"),),
    shades=False,
    blurs=True,
)


def targets(names):
    """Return the names of the colour targets, by slot, that the named passes need."""
    return (*_GEOMETRY, _DETAIL) if "Detail" in names else _GEOMETRY


def target(names, through_lens=False):
    """Return the `SurfaceTarget` of the named passes, seen by a pinhole or through a real lens."""
    made = surface_target.through_lens(_STILL) if through_lens else _STILL
    if "Vector" in names:
        made = replace(
            made,
            varyings=(("VEC4", "previous_clip"), ("VEC4", "next_clip")),
            samplers=(*made.samplers, ("FLOAT_2D", "previous_tx"), ("FLOAT_2D", "next_tx")),
            defines=(*made.defines, "HAS_VECTOR"),
        )
    if "Detail" in names:
        made = replace(
            made,
            outputs=(*made.outputs, ("VEC4", f"out_{_DETAIL}")),
            defines=(*made.defines, "HAS_DETAIL"),
        )
    return made


def empty_values(empty_coc):
    """Return the value of each target where there is no surface.

    Parameters
    ----------
    empty_coc : float
        Signed circle of confusion of what surrounds the scene, in pixels.

    Returns
    -------
    dict of str to tuple of 4 float
    """
    return {
        "normal_depth": (0.0, 0.0, 0.0, EMPTY_DEPTH),
        "position_coc": (0.0, 0.0, 0.0, empty_coc),
        "vector": (0.0, 0.0, 0.0, 0.0),
        "detail": (0.0, 0.0, 0.0, 0.0),
    }


def data_params(previous, following, width, height, alpha_threshold):
    """Upload the block of the data passes.

    Parameters
    ----------
    previous, following : ndarray of shape (4, 4)
        World to clip space of the region in the neighbouring frames.
    width, height : int
        Of the region, in pixels.
    alpha_threshold : float

    Returns
    -------
    GPUUniformBuf
    """
    return uniform_buffer(
        DATA_PARAMS.pack(
            previous=previous,
            next=following,
            raster=(width / 2.0, height / 2.0, alpha_threshold, 0.0),
        )
    )


def draw(draws, view_buffer, instances, bindings, lens=None):
    """Draw the data passes into the bound frame buffer, over `targets` by slot.

    Parameters
    ----------
    draws : list of surface.Draw
        Built for `target`.
    view_buffer : GPUUniformBuf
    instances : GPUTexture
    bindings : tuple of (str, GPUUniformBuf or GPUTexture)
        ``data_buf``, and with movement ``previous_tx`` and ``next_tx``.
    lens : real_lens.LensSample or None
        Of the middle of a real lens.
    """
    middle = np.zeros(4).tolist()
    surface.draw_sample(draws, view_buffer, instances, middle, 0, bindings, optics=lens)
