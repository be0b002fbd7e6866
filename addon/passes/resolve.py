"""From the sum of the samples to the picture (methods 1), through its distortion (methods 13)."""

import numpy as np

from ..device import shader_source
from ..device.shader_variants import variants
from ..device.shaders import ShaderInfo, compile_shader
from .surface import real_lens
from .tile_scales import KINDS, defines


@variants(
    lambda distorted, by_channel, tiled, lit, **_: (
        not ((tiled or lit) and (distorted or by_channel)) and not (tiled and lit)
    ),
    with_bokeh=(False, True),
    by_channel=(False, True),
    distorted=(False, True),
    tiled=KINDS,
    lit=(False, True),
)
def _info(with_bokeh, by_channel, distorted, tiled, lit=False):
    return ShaderInfo(
        name="aplanat_resolve",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/resolve_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=(
            ("FLOAT_2D", "sum_tx"),
            *(("FLOAT_2D", "bokeh_tx"),) * with_bokeh,
            *(("FLOAT_2D", "scales_tx"),) * bool(tiled),
            *real_lens.LIGHT_SAMPLERS * lit,
        ),
        push_constants=(
            *(("VEC4" if by_channel else "FLOAT", "scale"),) * (not (tiled or lit)),
            *real_lens.LIGHT_CONSTANTS * lit,
            ("IVEC2", "origin"),
            ("INT", "pixel_size"),
            *(
                (
                    *(("VEC4", name) for name in ("to_field", "from_field", "terms")),
                    ("VEC3", "model"),
                )
                if distorted
                else ()
            ),
        ),
        defines=(
            *(("BOKEH", "1"),) * with_bokeh,
            *(("DISTORTED", "1"),) * distorted,
            *defines(tiled),
            *real_lens.LIGHT_DEFINES * lit,
        ),
    )


def resolve(
    fullscreen,
    total,
    weight,
    origin=(0, 0),
    pixel_size=1,
    bokeh=None,
    distortion=None,
    scales=None,
    light=None,
):
    """Draw the mean of the samples into the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    total : GPUTexture
        Sum of the samples.
    weight : float or tuple of 4 float
        Summed weight of the samples; of each channel, where they differ.
    origin : tuple of 2 int
        Where the picture's lower left pixel goes, in pixels of the frame buffer.
    pixel_size : int
        Side of the square of the frame buffer that shows one pixel of the picture.
    bokeh : GPUTexture or None
        Added to the mean.
    distortion : DistortionPlan or None
        Where the picture's pixels lie in the textures; None: they are those of the textures.
    scales : TileScales or None
        Instead of the weight. Not with distortion.
    light : real_lens.SampleLight or None
        Instead of the weight: sums of the weights over the picture. Not with distortion.
    """
    by_channel = isinstance(weight, tuple)
    tiled = scales and scales.corners
    by_channel = by_channel and light is None
    features = (by_channel, distortion is not None, tiled, light is not None)
    shader = compile_shader(_info(bokeh is not None, *features))
    shader.bind()
    shader.uniform_sampler("sum_tx", total)
    if bokeh is not None:
        shader.uniform_sampler("bokeh_tx", bokeh)
    if tiled:
        shader.uniform_sampler("scales_tx", scales.texture)
    elif light is not None:
        light.bind(shader)
    else:
        scale = tuple(1.0 / w for w in weight) if by_channel else 1.0 / weight
        shader.uniform_float("scale", scale)
    shader.uniform_int("origin", origin)
    shader.uniform_int("pixel_size", pixel_size)
    if distortion is not None:
        shader.uniform_float("to_field", distortion.to_field.tolist())
        shader.uniform_float("from_field", distortion.from_field.tolist())
        # The standard deviation of the filter's box.
        blur = distortion.filter_width / np.sqrt(12.0)
        square = distortion.radius**2
        shader.uniform_float("terms", distortion.terms)
        shader.uniform_float("model", (square, distortion.fineness, float(blur)))
    shader.draw(fullscreen)
