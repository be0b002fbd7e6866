"""From the sum of the samples to the picture (methods 1)."""

from dataclasses import replace

from ..device import shader_source
from ..device.shaders import ShaderInfo, compile_shader

_INFO = ShaderInfo(
    name="aplanat_resolve",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/resolve_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "sum_tx"),),
    push_constants=(("FLOAT", "scale"), ("IVEC2", "origin"), ("INT", "pixel_size")),
)
_BY_CHANNEL = replace(_INFO, push_constants=(("VEC4", "scale"), *_INFO.push_constants[1:]))


def resolve(fullscreen, total, weight, origin=(0, 0), pixel_size=1):
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
    """
    by_channel = isinstance(weight, tuple)
    shader = compile_shader(_BY_CHANNEL if by_channel else _INFO)
    shader.bind()
    shader.uniform_sampler("sum_tx", total)
    scale = tuple(1.0 / w for w in weight) if by_channel else 1.0 / weight
    shader.uniform_float("scale", scale)
    shader.uniform_int("origin", origin)
    shader.uniform_int("pixel_size", pixel_size)
    fullscreen.draw(shader)
