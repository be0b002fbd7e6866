"""Adding a lens sample to the sums (methods 1)."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader

_COLOR = ShaderInfo(
    name="aplanat_accumulate",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/accumulate_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "sample_tx"),),
)

_FOCUS = ShaderInfo(
    name="aplanat_accumulate_focus",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/focus_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("FLOAT", "out_share"),),
    samplers=(("FLOAT_2D", "mattes_tx"),),
)


def accumulate(fullscreen, sample):
    """Add a colour texture to the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    sample : GPUTexture
        Of the frame buffer's size.
    """
    _add(fullscreen, _COLOR, "sample_tx", sample)


def accumulate_focus(fullscreen, mattes):
    """Add a sample's share of sharpness to the bound frame buffer of one channel.

    Parameters
    ----------
    fullscreen : GPUBatch
    mattes : GPUTexture
        Second target of `surface.COLOR_AND_MATTES`.
    """
    _add(fullscreen, _FOCUS, "mattes_tx", mattes)


def _add(fullscreen, info, name, texture):
    state.additive()
    shader = compile_shader(info)
    shader.bind()
    shader.uniform_sampler(name, texture)
    fullscreen.draw(shader)
