"""Adding a lens sample to the sums (methods 1).

A lens sample's raster has a grid of sub-pixels for each pixel of the sums; their weights make the
pixel filter (see `sampling.pixel_filter`).
"""

from ..device import shader_source, state
from ..device.shader_variants import variants
from ..device.shaders import ShaderInfo, compile_shader
from ..sampling.pixel_filter import MOST_SUBPIXELS
from .surface import chromatic, real_lens

# Name, fragment shader, output and sampler of each kind of sum.
_PICTURE = ("aplanat_accumulate", "passes/accumulate_frag.glsl", ("VEC4", "out_color"), "sample_tx")
_FOCUS = ("aplanat_accumulate_focus", "passes/focus_frag.glsl", ("FLOAT", "out_share"), "mattes_tx")


@variants(
    # The focus matte has one channel and no tint.
    allowed=lambda kind, subpixels, tinted, lit: kind is _PICTURE or not tinted,
    kind=(_PICTURE, _FOCUS),
    subpixels=range(1, MOST_SUBPIXELS + 1),
    tinted=(False, True),
    lit=(False, True),
)
def _info(kind, subpixels, tinted=False, lit=False):
    name, fragment, output, sampler = kind
    return ShaderInfo(
        name=name,
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load(fragment),
        attributes=(("VEC2", "pos"),),
        outputs=(output,),
        samplers=(("FLOAT_2D", sampler), *real_lens.LIGHT_SAMPLERS * lit),
        push_constants=(
            *(("VEC4", "columns"), ("VEC4", "rows")),
            *(("VEC4", "tint"),) * tinted,
            *(*real_lens.LIGHT_CONSTANTS, ("VEC2", "size")) * lit,
        ),
        defines=(
            ("SUBPIXELS", str(subpixels)),
            *chromatic.DEFINES * tinted,
            *real_lens.LIGHT_DEFINES * lit,
        ),
    )


def padded(weights):
    """Return up to 4 weights as a vector of 4."""
    return (*map(float, weights), 0.0, 0.0, 0.0)[:4]


def accumulate(fullscreen, sample, weights, tint=None, light=None):
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
    light : real_lens.SampleLight, optional
        What the lens lets through; without it the same everywhere.
    """
    _add(fullscreen, _PICTURE, sample, weights, tint, light)


def accumulate_focus(fullscreen, mattes, weights, light=None):
    """Add a lens sample's focus matte to the bound frame buffer of one channel.

    Parameters
    ----------
    fullscreen : GPUBatch
    mattes : GPUTexture
        Second target of `passes.surface.surface_target.COLOR_AND_MATTES`, as large as the sample.
    weights : ndarray of shape (2, k)
    light : real_lens.SampleLight, optional
    """
    _add(fullscreen, _FOCUS, mattes, weights, None, light)


def _add(fullscreen, kind, texture, weights, tint, light):
    state.additive()
    shader = compile_shader(_info(kind, len(weights[0]), tint is not None, light is not None))
    shader.bind()
    shader.uniform_sampler(kind[-1], texture)
    shader.uniform_float("columns", padded(weights[0]))
    shader.uniform_float("rows", padded(weights[1]))
    if tint is not None:
        shader.uniform_float("tint", tint)
    if light is not None:
        light.bind(shader)
        count = len(weights[0])
        shader.uniform_float("size", (texture.width / count, texture.height / count))
    shader.draw(fullscreen)
