"""Cryptomattes: which objects and materials a pixel shows through the lens, and how much of each.

Each lens sample's ids are counted in a small table a pixel, so that coverage is exactly that of the
blurred picture. A table has two slots more than the ranks that are shown: memory does not depend on
the number of samples, and only pixels that see more ids than slots are approximate, in their least
ranks.

References
----------
Friedman and Jones, *Fully automatic ID mattes with support for motion blur and transparency*,
SIGGRAPH 2015.
"""

from ..device import shader_source
from ..device.shader_variants import variants
from ..device.shaders import ShaderInfo, compile_shader, dispatch
from ..sampling.pixel_filter import MOST_SUBPIXELS
from ..sampling.tile_control import TILE
from .accumulate import padded
from .surface import real_lens
from .tile_scales import KINDS, defines

# Channel of the second target of `surface_target.COLOR_AND_MATTES` that holds the id.
CHANNELS = {"CryptoObject": 0, "CryptoMaterial": 1}

_GROUP = 8
_TILED = (("TILED", "1"), ("TILE", str(TILE)))
_SPARE_PAIRS = 1
# Levels that Blender offers, two to a pass, and the pairs of slots that they may need.
MOST_LEVELS = 16
_PAIRS = tuple(passes + _SPARE_PAIRS for passes in range(1, MOST_LEVELS // 2 + 1))


def slot_pairs(kinds):
    """Return how many pairs of slots a table has.

    Parameters
    ----------
    kinds : dict of str to int
        Passes of two ranks each, by kind.
    """
    return max(kinds.values()) + _SPARE_PAIRS


@variants(
    pairs=_PAIRS,
    subpixels=range(1, MOST_SUBPIXELS + 1),
    tiled=(False, True),
    lit=(False, True),
)
def _count_info(pairs, subpixels, tiled, lit=False):
    return ShaderInfo(
        name="aplanat_cryptomatte_count",
        compute=shader_source.load("passes/cryptomatte_comp.glsl"),
        samplers=(
            ("FLOAT_2D", "mattes_tx"),
            *(("FLOAT_2D", "active_tx"),) * tiled,
            *real_lens.LIGHT_SAMPLERS * lit,
        ),
        images=(("RGBA32F", "FLOAT_2D_ARRAY", "tables_img", ("READ", "WRITE")),),
        push_constants=(
            ("VEC4", "columns"),
            ("VEC4", "rows"),
            ("IVEC2", "channels"),
            ("INT", "kinds"),
            *real_lens.LIGHT_CONSTANTS * lit,
        ),
        defines=(
            ("SLOT_PAIRS", str(pairs)),
            ("SUBPIXELS", str(subpixels)),
            *_TILED * tiled,
            *real_lens.LIGHT_DEFINES * lit,
        ),
        local_size=(_GROUP, _GROUP, 1),
    )


@variants(
    allowed=lambda pairs, tiled, lit: not (tiled and lit),
    pairs=_PAIRS,
    tiled=KINDS,
    lit=(False, True),
)
def _rank_info(pairs, tiled, lit=False):
    return ShaderInfo(
        name="aplanat_cryptomatte_rank",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/cryptomatte_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=(
            ("FLOAT_2D_ARRAY", "tables_tx"),
            *(("FLOAT_2D", "scales_tx"),) * bool(tiled),
            *real_lens.LIGHT_SAMPLERS * lit,
        ),
        push_constants=(
            ("INT", "first_layer"),
            ("INT", "rank"),
            *(("FLOAT", "scale"),) * (not (tiled or lit)),
            *real_lens.LIGHT_CONSTANTS * lit,
        ),
        defines=(
            ("SLOT_PAIRS", str(pairs)),
            *defines(tiled),
            *real_lens.LIGHT_DEFINES * lit,
        ),
    )


def count(mattes, tables, kinds, weights, active=None, light=None):
    """Count the ids of a lens sample.

    Parameters
    ----------
    mattes : GPUTexture
        The sample's ids.
    tables : GPUTexture
        ``slot_pairs(kinds)`` layers a kind, cleared to zero before the first sample.
    kinds : dict of str to int
        As `snapshot.render_passes.cryptomatte_kinds` gives them.
    weights : ndarray of shape (2, k)
        Of the columns and rows of a pixel's sub-pixels; `mattes` is ``k`` times as large.
    active : GPUTexture or None
        1 for the tiles that the sample is drawn for, else 0; None: all tiles.
    light : real_lens.SampleLight, optional
        What the lens lets through; without it the same everywhere.
    """
    subpixels = len(weights[0])
    features = (active is not None, light is not None)
    shader = compile_shader(_count_info(slot_pairs(kinds), subpixels, *features))
    channels = [CHANNELS[kind] for kind in kinds]
    shader.bind()
    shader.uniform_sampler("mattes_tx", mattes)
    if active is not None:
        shader.uniform_sampler("active_tx", active)
    if light is not None:
        light.bind(shader)
    shader.image("tables_img", tables)
    shader.uniform_int("kinds", len(channels))
    shader.uniform_int("channels", (channels + [0])[:2])
    shader.uniform_float("columns", padded(weights[0]))
    shader.uniform_float("rows", padded(weights[1]))
    width, height = mattes.width // subpixels, mattes.height // subpixels
    dispatch(shader, -(-width // _GROUP), -(-height // _GROUP))


def draw_ranks(fullscreen, tables, kinds, kind, index, weight, scales=None, light=None):
    """Draw one pass of two ranks into the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    tables : GPUTexture
    kinds : dict of str to int
    kind : str
        ``"CryptoObject"`` or ``"CryptoMaterial"``.
    index : int
        0 holds ranks 0 and 1, 1 holds 2 and 3, ...
    weight : float
        Summed weight of the samples.
    scales : tile_scales.TileScales or None
        Used instead of `weight`.
    light : real_lens.SampleLight or None
        Used instead: sums of the weights over the picture.
    """
    pairs = slot_pairs(kinds)
    shader = compile_shader(_rank_info(pairs, scales and scales.corners, light is not None))
    shader.bind()
    shader.uniform_sampler("tables_tx", tables)
    shader.uniform_int("first_layer", list(kinds).index(kind) * pairs)
    shader.uniform_int("rank", 2 * index)
    if scales is not None:
        shader.uniform_sampler("scales_tx", scales.texture)
    elif light is not None:
        light.bind(shader)
    else:
        shader.uniform_float("scale", 1.0 / weight)
    shader.draw(fullscreen)
