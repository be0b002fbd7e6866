"""The error of a picture, tile by tile, from how it changed while samples were added.

In units of the noise threshold: 1 - SSIM of the picture as displayed in sRGB (Wang et al., IEEE
TIP 13(4), 2004; Gaussian window, sigma 1.5 px). Windows lie every 4 px: they overlap so much that
a denser grid would add no information. Alpha counts where its error is larger than the colours'.
"""

from ..device import shader_source, state
from ..device.shader_variants import variants
from ..device.shaders import ShaderInfo, compile_shader
from ..device.targets import TargetSpec
from ..sampling.tile_control import TILE
from .tile_scales import KINDS, defines

STRIDE, RADIUS = 4, 5
_DEFINES = (("STRIDE", str(STRIDE)), ("RADIUS", str(RADIUS)))


_SAMPLERS = {
    "display": ("sum_tx", "scales_tx"),
    "windows": ("picture_tx", "earlier_tx"),
    "tiles": ("windows_tx",),
}
_CONSTANTS = {"windows": (("FLOAT", "rest"),), "tiles": (("IVEC2", "count"),)}


@variants(
    lambda name, with_bokeh, corners: name == "display" or not (with_bokeh or corners > 1),
    name=("display", "windows", "tiles"),
    with_bokeh=(False, True),
    corners=KINDS[1:],
)
def _info(name, with_bokeh=False, corners=1):
    samplers = _SAMPLERS[name] + ("bokeh_tx",) * with_bokeh
    return ShaderInfo(
        name=f"aplanat_picture_{name}",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load(f"passes/picture_{name}_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=tuple(("FLOAT_2D", sampler) for sampler in samplers),
        push_constants=_CONSTANTS.get(name, ()),
        defines=(*_DEFINES, *defines(corners), *(("BOKEH", "1"),) * with_bokeh),
    )


def specs(width, height, pictures):
    """Return the targets that measuring needs.

    Parameters
    ----------
    width, height : int
        Of the picture, px.
    pictures : sequence of str
        Names of targets for pictures as displayed.

    Returns
    -------
    list of TargetSpec
        Also ``windows`` and ``tile_errors``.
    """
    return [
        # Half floats hold sRGB-encoded values to a tenth of a step of an 8-bit display.
        *(TargetSpec(name, "RGBA16F") for name in pictures),
        TargetSpec("windows", "RGBA32F", size=(-(-width // STRIDE), -(-height // STRIDE))),
        TargetSpec("tile_errors", "RGBA32F", size=(-(-width // TILE), -(-height // TILE))),
    ]


def display(fullscreen, total, scales, bokeh=None):
    """Draw a picture as displayed into the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    total : GPUTexture
        Sum of the samples.
    scales : tile_scales.TileScales
        Of their weights.
    bokeh : GPUTexture or None
        Added to the mean.
    """
    state.overwrite()
    shader = compile_shader(_info("display", bokeh is not None, scales.corners))
    shader.bind()
    shader.uniform_sampler("sum_tx", total)
    shader.uniform_sampler("scales_tx", scales.texture)
    if bokeh is not None:
        shader.uniform_sampler("bokeh_tx", bokeh)
    shader.draw(fullscreen)


def measure(fullscreen, targets, picture, earlier, rest):
    """Measure the error of every tile into the target ``tile_errors``.

    Parameters
    ----------
    fullscreen : GPUBatch
    targets : Targets
        With those of `specs`.
    picture, earlier : str
        Names of the pictures.
    rest : float
        Variance of the error that is left over the variance of the change since `earlier`.
    """
    state.overwrite()
    with targets.framebuffer("windows").bind():
        shader = compile_shader(_info("windows"))
        shader.bind()
        shader.uniform_sampler("picture_tx", targets[picture])
        shader.uniform_sampler("earlier_tx", targets[earlier])
        shader.uniform_float("rest", rest)
        shader.draw(fullscreen)
    with targets.framebuffer("tile_errors").bind():
        windows = targets["windows"]
        shader = compile_shader(_info("tiles"))
        shader.bind()
        shader.uniform_sampler("windows_tx", windows)
        shader.uniform_int("count", (windows.width, windows.height))
        shader.draw(fullscreen)
