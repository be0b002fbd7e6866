"""Mip pyramid of a lens sample: mean colours and depth ranges of ever larger squares."""

from ..device import shader_source
from ..device.shaders import ShaderInfo, compile_shader, dispatch

_GROUP = 8

_INFO = ShaderInfo(
    name="aplanat_pyramid",
    compute=shader_source.load("passes/pyramid_comp.glsl"),
    samplers=(("FLOAT_2D", "sample_tx"), ("FLOAT_2D", "depth_tx")),
    images=(
        ("RGBA32F", "FLOAT_2D_ARRAY", "means_img", ("READ", "WRITE")),
        ("RG32F", "FLOAT_2D_ARRAY", "ranges_img", ("READ", "WRITE")),
    ),
    push_constants=(("INT", "level"), ("INT", "means"), ("IVEC2", "film")),
    local_size=(_GROUP, _GROUP, 1),
)


def build(sample, depth, means, ranges, top, levels):
    """Fill the mip pyramid of a lens sample.

    Parameters
    ----------
    sample, depth : GPUTexture
        Colour and depth, of the same size.
    means, ranges : GPUTexture
        RGBA32F and RG32F arrays of half that size, rounded up. Layer i holds the squares of
        2^(i + 1) texels, from its lower left corner on.
    top, levels : int
        Layers of means and of ranges that are filled; not more means than ranges.
    """
    shader = compile_shader(_INFO)
    shader.bind()
    shader.uniform_sampler("sample_tx", sample)
    shader.uniform_sampler("depth_tx", depth)
    shader.image("means_img", means)
    shader.image("ranges_img", ranges)
    shader.uniform_int("film", (sample.width, sample.height))
    shader.uniform_int("means", top)
    for level in range(1, levels + 1):
        shader.uniform_int("level", level)
        width, height = (-(-side // 2**level) for side in (sample.width, sample.height))
        dispatch(shader, -(-width // _GROUP), -(-height // _GROUP))
