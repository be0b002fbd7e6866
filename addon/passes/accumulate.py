"""Adding a lens sample to the sums (methods 1).

A lens sample's raster has a grid of sub-pixels for each pixel of the sums; their weights make the
pixel filter (see `sampling.pixel_filter`).
"""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader
from . import chromatic


def _info(name, fragment, output, sampler, subpixels, tinted=False):
    return ShaderInfo(
        name=name,
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load(fragment),
        attributes=(("VEC2", "pos"),),
        outputs=(output,),
        samplers=(("FLOAT_2D", sampler),),
        push_constants=(("VEC4", "columns"), ("VEC4", "rows"), *[("VEC4", "tint")] * tinted),
        defines=(("SUBPIXELS", str(subpixels)), *chromatic.DEFINES * tinted),
    )


def padded(weights):
    """Return up to 4 weights as a vector of 4."""
    return (*map(float, weights), 0.0, 0.0, 0.0)[:4]


def accumulate(fullscreen, sample, weights, tint=None):
    """Add a colour texture to the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    sample : GPUTexture
        ``k`` times as large as the frame buffer, along each side.
    weights : ndarray of shape (2, k)
        Of the columns and the rows of a pixel's sub-pixels.
    tint : tuple of 4 float, optional
        Of the channels; without it all have weight 1.
    """
    output = ("VEC4", "out_color")
    info = ("aplanat_accumulate", "passes/accumulate_frag.glsl", output, "sample_tx")
    _add(fullscreen, info, sample, weights, tint)


def accumulate_focus(fullscreen, mattes, weights):
    """Add a sample's share of sharpness to the bound frame buffer of one channel.

    Parameters
    ----------
    fullscreen : GPUBatch
    mattes : GPUTexture
        Second target of `surface.COLOR_AND_MATTES`, as large as the sample.
    weights : ndarray of shape (2, k)
    """
    output = ("FLOAT", "out_share")
    info = ("aplanat_accumulate_focus", "passes/focus_frag.glsl", output, "mattes_tx")
    _add(fullscreen, info, mattes, weights)


def _add(fullscreen, info, texture, weights, tint=None):
    state.additive()
    shader = compile_shader(_info(*info, len(weights[0]), tint is not None))
    shader.bind()
    shader.uniform_sampler(info[-1], texture)
    shader.uniform_float("columns", padded(weights[0]))
    shader.uniform_float("rows", padded(weights[1]))
    if tint is not None:
        shader.uniform_float("tint", tint)
    shader.draw(fullscreen)
