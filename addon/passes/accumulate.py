"""Adding a lens sample to the sum (methods 1)."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader

_INFO = ShaderInfo(
    name="aplanat_accumulate",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/accumulate_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "sample_tx"),),
)


def accumulate(fullscreen, sample):
    """Add a texture to the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    sample : GPUTexture
        Of the frame buffer's size.
    """
    state.additive()
    shader = compile_shader(_INFO)
    shader.bind()
    shader.uniform_sampler("sample_tx", sample)
    fullscreen.draw(shader)
