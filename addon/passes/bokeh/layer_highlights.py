"""Highlights of captured layers: listed like fragments, and taken out of the layers (methods 9).

Pixels come in textures of `COLUMNS` columns, see `entry_textures`.
"""

import numpy as np

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.textures import texture_2d
from ...device.uniforms import bind_resource
from ..surface import chromatic
from ..surface.surface import HIGHLIGHT_PARAMS, VIEW_PARAMS
from ..visibility.prefix_sums import COLUMNS
from .highlights import APPEND_CONSTANTS, APPEND_DEFINES, APPEND_IMAGES

_THREADS = 64
_SAMPLERS = (("FLOAT_2D", "place_tx"), ("FLOAT_2D", "light_tx"))


@variants(
    # Listing takes all the light; what of it is splatted is decided later.
    allowed=lambda work, in_wavelengths: work == "SPLIT" or not in_wavelengths,
    work=("SPLIT", "WHOLE", "LIST"),
    in_wavelengths=(False, True),
)
def _info(work, in_wavelengths=False):
    lists = work == "LIST"
    colors = (("RGBA16F", "FLOAT_2D_ARRAY", "colors_img", ("WRITE",)),)
    structs = (VIEW_PARAMS.source + HIGHLIGHT_PARAMS.source) * (work != "WHOLE")
    uniforms = (("ViewParams", "view_buf"), ("HighlightParams", "highlight_buf"))
    info = ShaderInfo(
        name="aplanat_layer_highlights",
        compute=shader_source.load("passes/bokeh/layer_highlights_comp.glsl"),
        typedefs=structs,
        samplers=_SAMPLERS
        + (("FLOAT_2D", "front_tx"),) * lists
        + (("FLOAT_2D", "surroundings_tx"),) * (work != "WHOLE"),
        images=APPEND_IMAGES if lists else colors,
        uniforms=uniforms * (work != "WHOLE"),
        push_constants=(("INT", "first"), ("INT", "number"), *APPEND_CONSTANTS * lists),
        defines=((work, "1"), *APPEND_DEFINES),
        local_size=(_THREADS, 1, 1),
    )
    return chromatic.over_field(info) if in_wavelengths else info


def entry_textures(place, light, front):
    """Upload pixels of layers.

    Parameters
    ----------
    place : ndarray of shape (N, 4)
        Column, row, layer, value of the depth buffer.
    light : ndarray of shape (N, 4)
        Radiance, coverage.
    front : ndarray of shape (N, 2)
        Value of the depth buffer of what hides it from the lens' centre, 0: nothing does, and the
        share of its light that passes there.

    Returns
    -------
    tuple of 3 GPUTexture
    """
    rows = max(1, -(-len(front) // COLUMNS))

    def texture(values, texel_format):
        table = np.zeros((rows * COLUMNS, values.shape[1]), np.float32)
        table[: len(values)] = values
        return texture_2d(table.reshape(rows, COLUMNS, -1), texel_format)

    return texture(place, "RGBA32F"), texture(light, "RGBA32F"), texture(front, "RG32F")


def append(entries, first, number, split, view, lists):
    """Append pixels of layers to fragment lists, those that only dim with no light.

    Those that something right in front hides from the whole lens are left out.

    Parameters
    ----------
    entries : tuple of 3 GPUTexture
    first, number : int
        Which of them.
    split : split_light.SplitLight
    view : GPUUniformBuf
        `ViewParams` of the layers' raster.
    lists : passes.bokeh.highlights.FragmentLists
        Cleared.
    """
    shader = _bind(_info("LIST"), entries, first, number)
    shader.uniform_sampler("front_tx", entries[2])
    shader.uniform_block("view_buf", view)
    split.bind(shader)
    for name, resource in lists.bindings():
        bind_resource(shader, name, resource)
    dispatch(shader, -(-number // _THREADS), 1)


def leave_base(entries, number, colors, split, view, field=None):
    """Replace the highlights in layers by the light that the lens samples keep of them.

    Parameters
    ----------
    entries : tuple of 3 GPUTexture
    number : int
        Of pixels.
    colors : GPUTexture
        Of the layers.
    split : split_light.SplitLight
    view : GPUUniformBuf
        `ViewParams` of the layers' raster.
    field : tuple of (str, GPUUniformBuf or GPUTexture) or None
        `passes.surface.chromatic.resources`, with chromatic aberration.
    """
    shader = _bind(_info("SPLIT", field is not None), entries, 0, number)
    shader.image("colors_img", colors)
    shader.uniform_block("view_buf", view)
    split.bind(shader)
    for name, resource in field or ():
        bind_resource(shader, name, resource)
    dispatch(shader, -(-number // _THREADS), 1)


def give_back(entries, number, colors):
    """Write all the light of highlights into layers; parameters as of `leave_base`."""
    shader = _bind(_info("WHOLE"), entries, 0, number)
    shader.image("colors_img", colors)
    dispatch(shader, -(-number // _THREADS), 1)


def _bind(info, entries, first, number):
    shader = compile_shader(info)
    shader.bind()
    for name, texture in zip(("place_tx", "light_tx"), entries[:2], strict=True):
        shader.uniform_sampler(name, texture)
    shader.uniform_int("first", first)
    shader.uniform_int("number", number)
    return shader
