"""N-buffers: the extremes of any rectangle of a depth buffer from four look-ups (methods 5).

References
----------
Decoret, *N-buffers for efficient depth map query*, Eurographics 2005.
"""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader, dispatch
from . import chromatic

_GROUP = 8

_BUILD = ShaderInfo(
    name="aplanat_nbuffer",
    compute=shader_source.load("passes/nbuffer_comp.glsl"),
    samplers=(("FLOAT_2D", "depth_tx"),),
    images=(("RG32F", "FLOAT_2D_ARRAY", "levels_img", ("READ", "WRITE")),),
    push_constants=(("INT", "level"),),
    local_size=(_GROUP, _GROUP, 1),
)

_BOUNDS = ShaderInfo(
    name="aplanat_blur_bounds",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/blur_bounds_frag.glsl"),
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC2", "out_bounds"),),
    samplers=(("FLOAT_2D_ARRAY", "levels_tx"),),
    push_constants=(("VEC4", "sweep"), ("VEC4", "opening")),
)
_BOUNDS_IN_WAVELENGTHS = chromatic.declared(_BOUNDS, (("VEC4", "gain"),))


def layers(reach):
    """Return how many layers answer for squares of up to `reach` texels to each side."""
    return max(1, (2 * int(reach) + 1).bit_length())


def build(depth, levels, count):
    """Fill a stack of N-buffers.

    Parameters
    ----------
    depth : GPUTexture
    levels : GPUTexture
        RG32F array of the same size with at least `count` layers.
    count : int
    """
    shader = compile_shader(_BUILD)
    shader.bind()
    shader.uniform_sampler("depth_tx", depth)
    shader.image("levels_img", levels)
    for level in range(count):
        shader.uniform_int("level", level)
        dispatch(shader, -(-depth.width // _GROUP), -(-depth.height // _GROUP))


def draw_bounds(fullscreen, levels, sweep, opening, depth_range, gain=None, wavelength=None):
    """Draw, into the bound frame buffer, the depths that can reach each pixel through the lens.

    Parameters
    ----------
    fullscreen : GPUBatch
    levels : GPUTexture
        The N-buffers.
    sweep : sequence of 4 float
        See ``lib/sweep_lib.glsl``.
    opening : sequence of 2 float
        Half width and height of the opening, m.
    depth_range : sequence of 2 float
        Least and largest value that the depth buffer may have.
    gain : sequence of 4 float, optional
        With chromatic aberration: of the sweep, by the inverse of the focus distance.
    wavelength : chromatic.ChromaticSample, optional
        Any one of the frame's.
    """
    state.overwrite()
    shader = compile_shader(_BOUNDS if wavelength is None else _BOUNDS_IN_WAVELENGTHS)
    shader.bind()
    shader.uniform_sampler("levels_tx", levels)
    shader.uniform_float("sweep", tuple(sweep))
    shader.uniform_float("opening", (*opening, *depth_range))
    if wavelength is not None:
        wavelength.bind_resources(shader)
        shader.uniform_float("gain", tuple(gain))
    shader.draw(fullscreen)
