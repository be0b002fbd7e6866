"""Depth peeling from one place on the lens, and lists of bright fragments (methods 9).

`OCCLUDERS`: depth-peeled layers of all surfaces, each the nearest behind the layer before.
`OPAQUE`: depth of the nearest opaque surface. `HIGHLIGHTS`: lists of all fragments brighter than
the highlight threshold. `CANDIDATES`, `GLINTS`: tiles in which reflecting surfaces are so bright,
or in which they are. `VEILS`, `OTHER_VEILS`: see-through fragments in front of highlights and
behind them. `HIDERS`: opaque surfaces right in front of these. `COVERS`: surfaces right in front of
the world.

References
----------
Everitt, *Interactive order-independent transparency*, NVIDIA 2001.
"""

from dataclasses import replace

from ...device import state
from ..surface import surface, surface_target
from . import highlights

OCCLUDERS = surface_target.SurfaceTarget(
    "passes/bokeh/peel_frag.glsl",
    (("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "front_tx"),),
    defines=("OCCLUDERS",),
    shades=False,
)
OPAQUE = replace(OCCLUDERS, outputs=(), samplers=(), defines=())
HIGHLIGHTS = surface_target.SurfaceTarget(
    "passes/bokeh/peel_frag.glsl",
    (),
    # Without the first (surfaces whose light is never splatted) only depth is written.
    defines=(surface_target.SPLIT,),
    samplers=highlights.COUNT_SAMPLERS,
    images=highlights.APPEND_IMAGES + highlights.COUNT_IMAGES,
    push_constants=highlights.APPEND_CONSTANTS,
    values=highlights.APPEND_DEFINES,
    splits=True,
)
HIDERS = surface_target.SurfaceTarget(
    "passes/bokeh/hiders_frag.glsl",
    (),
    images=highlights.TAKE_IMAGES,
    values=highlights.APPEND_DEFINES,
    shades=False,
)
COVERS = surface_target.SurfaceTarget(
    "passes/bokeh/covers_frag.glsl",
    (("VEC4", "out_color"),),
    push_constants=(("FLOAT", "nearest"),),
    shades=False,
)
# Reflecting surfaces of `HIGHLIGHTS`, to find where they have any: by their light, or anyway.
CANDIDATES = replace(
    HIGHLIGHTS,
    defines=(surface_target.SPLIT, "CANDIDATES"),
    samplers=(("FLOAT_2D", "means_tx"),),
    images=(("R32UI", "UINT_2D", "marks_img", ("READ", "WRITE")),),
    push_constants=(("INT", "tile_texels"),),
    values=(),
)
GLINTS = replace(CANDIDATES, defines=("CANDIDATES",), samplers=(), shades=False, splits=False)
# See-through surfaces of `HIGHLIGHTS`, where they are no highlight.
VEILS = replace(
    HIGHLIGHTS,
    defines=(surface_target.SPLIT, "VEILS"),
    samplers=(),
    images=highlights.APPEND_IMAGES,
)
# See-through surfaces that are not searched for highlights.
OTHER_VEILS = replace(VEILS, defines=("VEILS",), shades=False, splits=False)


def draw_layer(draws, view_buffer, instances, textures):
    """Draw one layer of occluders into the bound frame buffer.

    Parameters
    ----------
    draws : list of Draw
        Of `passes.surface.surface.build_draws` for `OCCLUDERS`.
    view_buffer : GPUUniformBuf
        `ViewParams` of the raster.
    instances : GPUTexture
        The instance table.
    textures : sequence of 1 GPUTexture
        Depth of the previous layer; all 0 for the first layer.
    """
    state.opaque()
    bindings = tuple(zip(("front_tx",), textures, strict=True))
    surface.draw_sample(draws, view_buffer, instances, (0.0, 0.0, 0.0, 0.0), 0, bindings)


def draw_opaque(draws, view_buffer, instances, lens):
    """Draw the depth of opaque surfaces into the bound frame buffer.

    Parameters
    ----------
    draws : list of Draw
        For `OPAQUE`.
    view_buffer, instances
        As for `draw_layer`.
    lens : tuple of 2 float
        Place on the lens that the scene is seen from, m.
    """
    state.opaque()
    surface.draw_sample(draws, view_buffer, instances, (*lens, 0.0, 0.0), 0)


def list_highlights(draws, view_buffer, instances, lens, lists, split, counts, counting, lights):
    """Append fragments above the highlight threshold to lists, and draw the depth of opaque ones.

    Parameters
    ----------
    draws : list of Draw
        For `HIGHLIGHTS`.
    view_buffer, instances, lens
        As for `draw_opaque`.
    lists : highlights.FragmentLists
        Cleared.
    split : split_light.SplitLight
    counts : highlights.TexelCounts
    counting : bool
        The texels that are drawn are added to `counts`.
    lights : passes.surface.light_map.Lighting
    """
    state.opaque()
    sample = (*lens, 0.0, 0.0)
    bindings = (*lists.bindings(), *counts.bindings(counting))
    surface.draw_sample(draws, view_buffer, instances, sample, 0, bindings, split, lights=lights)


def list_veils(draws, view_buffer, instances, lens, lists, split, lights):
    """Append see-through fragments without light above the threshold to lists that have any.

    Parameters
    ----------
    draws : list of Draw
        For `VEILS` or `OTHER_VEILS`, of see-through surfaces only.
    view_buffer, instances, lens
        As for `draw_opaque`.
    lists : highlights.FragmentLists
        With highlights; read since they were listed, so that the device has finished them.
    split : split_light.SplitLight
    lights : passes.surface.light_map.Lighting
    """
    state.opaque()
    sample = (*lens, 0.0, 0.0)
    bindings = lists.bindings()
    surface.draw_sample(draws, view_buffer, instances, sample, 0, bindings, split, lights=lights)


def hide_highlights(draws, view_buffer, instances, lens, lists):
    """Remove listed fragments that opaque surfaces hide from the whole lens.

    Parameters
    ----------
    draws : list of Draw
        For `HIDERS`.
    view_buffer, instances, lens
        As for `draw_opaque`; the bound frame buffer has the depth of the nearest opaque surfaces.
    lists : highlights.FragmentLists
        Read since highlights were listed, so that the device has finished them.
    """
    state.hidden()
    surface.draw_sample(draws, view_buffer, instances, (*lens, 0.0, 0.0), 0, lists.taken())


def cover_world(draws, view_buffer, instances, nearest):
    """Multiply the bound colour by the transmittance of surfaces as good as infinitely far.

    Parameters
    ----------
    draws : list of Draw
        For `COVERS`.
    view_buffer, instances
        As for `draw_layer`.
    nearest : float
        Depth from which on they are, m.
    """
    state.multiply()
    surface.draw_sample(draws, view_buffer, instances, (0.0,) * 4, 0, (("nearest", nearest),))


def mark_candidates(
    draws, view_buffer, instances, marks, tile, split=None, means=None, lights=None
):
    """Mark the tiles of a raster in which reflecting surfaces may have highlights.

    Parameters
    ----------
    draws : list of Draw
        For `CANDIDATES`, or for `GLINTS`.
    view_buffer, instances
        As for `draw_opaque`; a frame buffer of the raster's size is bound.
    marks : GPUTexture
        R32UI, a texel a tile: gets the bits of a number above 0.
    tile : int
        Texels along a side of a tile.
    split, means, lights : split_light.SplitLight, GPUTexture, passes.surface.light_map.Lighting
        For `CANDIDATES`; the means are the pyramid of `surroundings.find`.
    """
    state.overwrite()
    bindings = [("marks_img", marks), ("tile_texels", tile)]
    if means is not None:
        bindings.append(("means_tx", means))
    surface.draw_sample(
        draws, view_buffer, instances, (0.0,) * 4, 0, bindings, split, lights=lights
    )
