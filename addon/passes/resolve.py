"""From the sum of the samples to the picture (methods 1)."""

from ..device import shader_source
from ..device.shaders import ShaderInfo, compile_shader


def _info(with_bokeh, by_channel):
    return ShaderInfo(
        name="aplanat_resolve",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/resolve_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=(("FLOAT_2D", "sum_tx"),) + (("FLOAT_2D", "bokeh_tx"),) * with_bokeh,
        push_constants=(
            ("VEC4" if by_channel else "FLOAT", "scale"),
            ("IVEC2", "origin"),
            ("INT", "pixel_size"),
        ),
        defines=(("BOKEH", "1"),) * with_bokeh,
    )


def resolve(fullscreen, total, weight, origin=(0, 0), pixel_size=1, bokeh=None):
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
    """
    by_channel = isinstance(weight, tuple)
    shader = compile_shader(_info(bokeh is not None, by_channel))
    shader.bind()
    shader.uniform_sampler("sum_tx", total)
    if bokeh is not None:
        shader.uniform_sampler("bokeh_tx", bokeh)
    scale = tuple(1.0 / w for w in weight) if by_channel else 1.0 / weight
    shader.uniform_float("scale", scale)
    shader.uniform_int("origin", origin)
    shader.uniform_int("pixel_size", pixel_size)
    fullscreen.draw(shader)
