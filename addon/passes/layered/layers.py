"""Depth layers on the device, and the pyramids that rays look them up in (methods 7).

Layers are the slices of array textures. A depth is the value that the depth buffer of the whole
frame would hold, `EMPTY` where a layer has no surface; beside it stands the share of the texel that
has one, of layers whose colours are no filtered pictures.
"""

import numpy as np

from ...device import readback, shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.targets import TargetSpec, atlas_size, level_count, level_sizes, second_row

EMPTY = 2.0
COLOR_FORMAT, DEPTH_FORMAT = "RGBA16F", "RG32F"

_GROUP = 8
COLORS = (COLOR_FORMAT, "FLOAT_2D_ARRAY")
DEPTHS = (DEPTH_FORMAT, "FLOAT_2D_ARRAY")
MATTES = ("RGBA32F", "FLOAT_2D_ARRAY")
_RANGES = ("RGBA32F", "FLOAT_2D_ARRAY")


@variants(mattes=(False, True))
def _pack_info(mattes=False):
    images = [(*COLORS, "colors_img", ("WRITE",)), (*DEPTHS, "depths_img", ("WRITE",))]
    samplers = [("FLOAT_2D", f"{name}_tx") for name in ("color", "depth", "shape")]
    if mattes:
        images.append((*MATTES, "mattes_img", ("WRITE",)))
        samplers.append(("FLOAT_2D", "mattes_tx"))
    return ShaderInfo(
        name="aplanat_layer_pack",
        compute=shader_source.load("passes/layered/layer_pack_comp.glsl"),
        samplers=tuple(samplers),
        images=tuple(images),
        push_constants=(
            ("INT", "layer"),
            ("INT", "color_layer"),
            ("VEC4", "slice"),
            ("VEC4", "whole"),
            ("INT", "parts"),
        ),
        defines=(("MATTES", "1"),) * mattes,
        local_size=(_GROUP, _GROUP, 1),
    )


_PYRAMID = ShaderInfo(
    name="aplanat_layer_pyramid",
    compute=shader_source.load("passes/layered/layer_pyramid_comp.glsl"),
    samplers=(("FLOAT_2D_ARRAY", "colors_tx"), ("FLOAT_2D_ARRAY", "depths_tx")),
    images=(
        (*COLORS, "means_img", ("READ", "WRITE")),
        (*_RANGES, "ranges_img", ("READ", "WRITE")),
    ),
    push_constants=(("INT", "level"), ("INT", "alpha_covers"), ("INT", "eyes")),
    local_size=(_GROUP, _GROUP, 1),
)


def specs(width, height, layers, mattes=False, eyes=1):
    """Return the targets that layers of a size need.

    Parameters
    ----------
    width, height, layers : int
    mattes : bool
    eyes : int
        Places on the lens that each layer's colours are seen from. Those from the first one come
        first, a slice a layer.

    Returns
    -------
    list of TargetSpec
        ``colors``, ``depths``, ``means``, ``ranges`` and, with mattes, ``mattes``.
    """
    atlas = atlas_size(width, height)
    found = [
        TargetSpec("colors", COLORS[0], layers * eyes),
        TargetSpec("depths", DEPTHS[0], layers),
        TargetSpec("means", COLORS[0], layers * eyes, size=atlas),
        TargetSpec("ranges", _RANGES[0], layers, size=atlas),
    ]
    if mattes:
        found.append(TargetSpec("mattes", MATTES[0], layers))
    return found


def depth_rows(projection):
    """Return how a projection makes clip z and w of z in camera space: 4 numbers.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
    """
    return tuple(np.asarray(projection)[2:, 2:].ravel().tolist())


def pack(drawn, layer, textures, slice_projection, projection, color_layer=None, parts=1):
    """Put a drawn slice into a layer.

    Parameters
    ----------
    drawn : dict of str to GPUTexture
        ``color``, ``depth`` and, with mattes, ``mattes`` of the slice; with parts ``shape``, the
        depths of its opaque surfaces.
    layer : int
    textures : Targets
        Of `specs`.
    slice_projection, projection : ndarray of shape (4, 4)
        Of the slice's depth buffer, and of the frame's.
    color_layer : int, optional
        Slice of ``colors`` that the colour goes to; default: `layer`.
    parts : int
        Texels of the shape along each side of one of the layer.
    """
    mattes = "mattes" in textures
    shader = compile_shader(_pack_info(mattes))
    shader.bind()
    shader.image("colors_img", textures["colors"])
    shader.image("depths_img", textures["depths"])
    shader.uniform_sampler("color_tx", drawn["color"])
    shader.uniform_sampler("depth_tx", drawn["depth"])
    shader.uniform_sampler("shape_tx", drawn["shape" if parts > 1 else "depth"])
    if mattes:
        shader.image("mattes_img", textures["mattes"])
        shader.uniform_sampler("mattes_tx", drawn["mattes"])
    shader.uniform_int("layer", layer)
    shader.uniform_int("color_layer", layer if color_layer is None else color_layer)
    shader.uniform_float("slice", depth_rows(slice_projection))
    shader.uniform_float("whole", depth_rows(projection))
    shader.uniform_int("parts", parts)
    depths = textures["depths"]
    dispatch(shader, -(-depths.width // _GROUP), -(-depths.height // _GROUP))


def build_pyramids(textures, width, height, layers, alpha_covers, eyes=1):
    """Fill the pyramids of all layers.

    Parameters
    ----------
    textures : Targets
        Of `specs`, with filled layers.
    width, height, layers : int
    alpha_covers : bool
        A texel is covered as much as its colour's alpha says, else wholly where it has a surface.
    eyes : int
        See `specs`.
    """
    shader = compile_shader(_PYRAMID)
    shader.bind()
    shader.uniform_sampler("colors_tx", textures["colors"])
    shader.uniform_sampler("depths_tx", textures["depths"])
    shader.image("means_img", textures["means"])
    shader.image("ranges_img", textures["ranges"])
    shader.uniform_int("alpha_covers", int(alpha_covers))
    shader.uniform_int("eyes", eyes)
    for level in range(1, level_count(width, height) + 1):
        shader.uniform_int("level", level)
        across, up = (-(-side // 2**level) for side in (width, height))
        dispatch(shader, -(-across // _GROUP), -(-up // _GROUP), layers)


def depth_range(textures, width, height, layer=0):
    """Read the least and the largest depth of a layer from its pyramid.

    Parameters
    ----------
    textures : Targets
        Of `specs`, with pyramids.
    width, height : int
        Of the layers.
    layer : int

    Returns
    -------
    least, largest : float
        The least is the greater one where the layer has no surface.
    """
    sizes = level_sizes(width, height)
    # The last level is one square.
    place = (sizes[0][0], second_row(height, len(sizes))) if len(sizes) > 1 else (0, 0)
    return tuple(readback.read_texel(textures["ranges"], layer, *place)[:2].tolist())
