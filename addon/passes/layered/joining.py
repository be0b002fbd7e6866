"""Joins the layers of a scene where a surface goes on from one into the next (methods 7)."""

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from .layers import COLORS, DEPTHS, MATTES

_GROUP = 8
_BOTH = ("READ", "WRITE")


@variants(mattes=(False, True))
def _info(mattes=False):
    return ShaderInfo(
        name="aplanat_layer_join",
        compute=shader_source.load("passes/layered/layer_join_comp.glsl"),
        images=(
            (*COLORS, "colors_img", _BOTH),
            (*DEPTHS, "depths_img", _BOTH),
            *((*MATTES, "mattes_img", _BOTH),) * mattes,
        ),
        push_constants=(("INT", "layer"), ("INT", "layers"), ("INT", "eyes")),
        defines=(("MATTES", "1"),) * mattes,
        local_size=(_GROUP, _GROUP, 1),
    )


def join(textures, layers, eyes=1):
    """Have slices of a scene overlap by a texel at least wherever a surface goes through a cut.

    Slices overlap by a share of their depth; where a texel of a surface is deeper than that, the
    one ends and the next begins in the texel beside it, and rays would pass between both.

    Parameters
    ----------
    textures : Targets
        Of `layers.specs`, with filled layers, the foremost first, and pyramids still to be built.
    layers : int
    eyes : int
        See `layers.specs`.
    """
    mattes = "mattes" in textures
    names = ("colors", "depths", "mattes")[: 2 + mattes]
    shader = compile_shader(_info(mattes))
    shader.bind()
    for name in names:
        shader.image(f"{name}_img", textures[name])
    shader.uniform_int("layers", layers)
    shader.uniform_int("eyes", eyes)
    size = textures["depths"]
    # One after the other: a layer may be a single row of a surface that comes out of the layer
    # before and goes on into the next.
    for layer in range(1, layers):
        shader.uniform_int("layer", layer)
        dispatch(shader, -(-size.width // _GROUP), -(-size.height // _GROUP))
