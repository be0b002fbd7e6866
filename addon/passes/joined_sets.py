"""Joining pixels that see through different places on the lens: the noise of few places goes."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader
from ..sampling.sequence import SETS
from .subsample import SORTED

_INFO = ShaderInfo(
    name="aplanat_joined_sets",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/joined_sets_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=tuple(("FLOAT_2D", f"{name}_tx") for name in SORTED),
    defines=(("PIXEL_SETS", str(SETS)),),
)


def join(fullscreen, targets):
    """Add a picture to the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    targets : Targets
        With those of `subsample.SORTED`, drawn by `subsample.blur`.
    """
    state.additive()
    shader = compile_shader(_INFO)
    shader.bind()
    for name in SORTED:
        shader.uniform_sampler(f"{name}_tx", targets[name])
    shader.draw(fullscreen)
