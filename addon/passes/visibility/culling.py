"""Culling of highlights: dropped, fully visible, or in need of a visibility mask (methods 10).

A test drops a highlight (its disc is outside the frame, or it is hidden from the whole lens) or
finds it fully visible (no surface of the peeled layers in front of it, no triangles in its cone,
see `passes.visibility.cones`). A test decides only where it is certain, so the picture is the same
without it. Masks that turn out to hide everything or nothing are found last, and not used.

The results lie in tables as the list of highlights does, `prefix_sums.COLUMNS` columns wide.

References
----------
Jeong et al., TVCG 2020, section 4.3; Decoret, *N-buffers for efficient depth map query*, EG 2005.
"""

from dataclasses import dataclass

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.uniform_block import UniformStruct
from . import prefix_sums
from .prefix_sums import COLUMNS

VISIBILITY_PARAMS = UniformStruct("shared/visibility_params.glsl", "VisibilityParams")
TILE_LAYOUT = UniformStruct("shared/tile_layout.glsl", "TileLayout")

# Masks have sides of this many texels times powers of two.
LEAST_SIDE = 8
SIZES = 6

# Places in the table of counts: sources by state (see lib/bokeh/source_lib.glsl), masks by size
# (behind them those that only a comparison wants), texels times steps of casting rays, pairs of
# source and cluster, masks that hide nothing and everything, pairs of source and instance of a
# group.
STATES = {"outside": (1,), "hidden": (2,), "visible": (3, 6), "masked": (4,), "free": (5,)}
COUNT_SIZES = 8
COUNT_WORK = 20
COUNT_PAIRS = 21
COUNT_WHOLE = 22
COUNT_EMPTY = 23
COUNT_GROUPS = 24

_THREADS = 64
_GROUP = 8

_DEFINES = (("SOURCE_COLUMNS", str(COLUMNS)),)

_BOUNDS = ShaderInfo(
    name="aplanat_bokeh_bounds",
    compute=shader_source.load("passes/visibility/bokeh_culling_bounds_comp.glsl"),
    samplers=(("FLOAT_2D", "layers_tx"), ("FLOAT_2D", "opacity_tx")),
    images=(("RGBA32F", "FLOAT_2D_ARRAY", "bounds_img", ("READ", "WRITE")),),
    push_constants=(("INT", "level"), ("INT", "cell")),
    local_size=(_GROUP, _GROUP, 1),
)


@variants(layered=(False, True))
def _cull_info(layered):
    samplers = [("FLOAT_2D", "sources_tx")]
    if layered:
        samplers += [("FLOAT_2D", "layers_tx"), ("FLOAT_2D_ARRAY", "bounds_tx")]
    return ShaderInfo(
        name="aplanat_bokeh_culling",
        compute=shader_source.load("passes/visibility/bokeh_culling_comp.glsl"),
        typedefs=VISIBILITY_PARAMS.source,
        samplers=tuple(samplers),
        images=(("RGBA32F", "FLOAT_2D", "states_img", ("READ", "WRITE")),),
        uniforms=(("VisibilityParams", "visibility_buf"),),
        push_constants=(("INT", "count"), *(("INT", "cell"), ("INT", "again")) * layered),
        defines=(*_DEFINES, *(("LAYERS", "1"),) * layered),
        local_size=(_THREADS, 1, 1),
    )


_KEYS = ShaderInfo(
    name="aplanat_bokeh_keys",
    compute=shader_source.load("passes/visibility/bokeh_culling_keys_comp.glsl"),
    typedefs=VISIBILITY_PARAMS.source,
    samplers=(("FLOAT_2D", "sources_tx"), ("FLOAT_2D", "states_tx")),
    images=(
        ("R32UI", "UINT_2D", "keys_img", ("WRITE",)),
        ("R32UI", "UINT_2D", "counts_img", ("READ", "WRITE")),
    ),
    uniforms=(("VisibilityParams", "visibility_buf"),),
    push_constants=(("INT", "count"), ("INT", "rows"), ("INT", "kinds")),
    defines=(
        *_DEFINES,
        ("SIZES", str(SIZES)),
        ("COUNT_SIZES", str(COUNT_SIZES)),
        ("COUNT_WORK", str(COUNT_WORK)),
    ),
    local_size=(_THREADS, 1, 1),
)

_TILES = ShaderInfo(
    name="aplanat_bokeh_tiles",
    compute=shader_source.load("passes/visibility/bokeh_culling_tiles_comp.glsl"),
    typedefs=VISIBILITY_PARAMS.source + TILE_LAYOUT.source,
    samplers=(
        ("FLOAT_2D", "sources_tx"),
        ("FLOAT_2D", "states_tx"),
        ("UINT_2D", "keys_tx"),
        ("UINT_2D", "totals_tx"),
    ),
    images=(
        ("RGBA32F", "FLOAT_2D", "tiles_img", ("WRITE",)),
        ("RGBA32F", "FLOAT_2D", "masked_img", ("WRITE",)),
    ),
    uniforms=(("VisibilityParams", "visibility_buf"), ("TileLayout", "layout_buf")),
    push_constants=(("INT", "count"), ("INT", "rows"), ("INT", "kind"), ("INT", "kinds")),
    defines=(*_DEFINES, ("SIZES", str(SIZES))),
    local_size=(_THREADS, 1, 1),
)

_MASKS = ShaderInfo(
    name="aplanat_bokeh_masks",
    compute=shader_source.load("passes/visibility/bokeh_culling_masks_comp.glsl"),
    typedefs=VISIBILITY_PARAMS.source,
    samplers=(("FLOAT_2D", "masks_tx"),),
    images=(
        ("RGBA32F", "FLOAT_2D", "tiles_img", ("READ", "WRITE")),
        ("R32UI", "UINT_2D", "counts_img", ("READ", "WRITE")),
    ),
    push_constants=(("INT", "count"),),
    defines=(
        *_DEFINES,
        ("COUNT_WHOLE", str(COUNT_WHOLE)),
        ("COUNT_EMPTY", str(COUNT_EMPTY)),
    ),
    local_size=(_THREADS, 1, 1),
)


def build_bounds(layers, opacity, bounds, levels, cell):
    """Fill a stack of N-buffers over the peeled layers.

    Parameters
    ----------
    layers, opacity : GPUTexture
        See `visibility_warp.pack`.
    bounds : GPUTexture
        RGBA32F array over cells of the raster, with at least `levels` layers.
    levels : int
    cell : int
        Texels along a side of a cell.
    """
    shader = compile_shader(_BOUNDS)
    shader.bind()
    shader.uniform_sampler("layers_tx", layers)
    shader.uniform_sampler("opacity_tx", opacity)
    shader.image("bounds_img", bounds)
    shader.uniform_int("cell", cell)
    for level in range(levels):
        shader.uniform_int("level", level)
        dispatch(shader, -(-bounds.width // _GROUP), -(-bounds.height // _GROUP))


def cull_frame(sources, count, parameters, states):
    """Drop the sources whose disc is outside the frame.

    Parameters
    ----------
    sources : GPUTexture
        First texture of the list.
    count : int
    parameters : GPUUniformBuf
        `VisibilityParams`.
    states : GPUTexture
        RGBA32F, as large as the list; gets the state of each source.
    """
    shader = _bind_cull(sources, count, parameters, states, layered=False)
    dispatch(shader, -(-count // _THREADS), 1)


def cull(sources, count, parameters, layers, bounds, cell, again, states):
    """Decide by the peeled layers which sources need a mask.

    Parameters
    ----------
    sources, count, parameters, states
        As for `cull_frame`.
    layers, bounds : GPUTexture
    cell : int
    again : bool
        Only sources that earlier tests have left undecided.
    """
    shader = _bind_cull(sources, count, parameters, states, layered=True)
    shader.uniform_sampler("layers_tx", layers)
    shader.uniform_sampler("bounds_tx", bounds)
    shader.uniform_int("cell", cell)
    shader.uniform_int("again", int(again))
    dispatch(shader, -(-count // _THREADS), 1)


def _bind_cull(sources, count, parameters, states, layered):
    shader = compile_shader(_cull_info(layered))
    shader.bind()
    shader.uniform_sampler("sources_tx", sources)
    shader.image("states_img", states)
    shader.uniform_block("visibility_buf", parameters)
    shader.uniform_int("count", count)
    return shader


@dataclass(frozen=True, eq=False)
class CullingTables:
    """Results of the culling tests on the device.

    Parameters
    ----------
    rows : int
        Of the list of sources.
    culls : bool
        False gives masks to the decided sources, too, for comparison.
    states : GPUTexture
        RGBA32F, as large as the list: see passes/visibility/bokeh_culling_comp.glsl.
    keys : GPUTexture
        R32UI, `segments` times as high.
    totals : GPUTexture
        R32UI, a texel for each row of `keys`.
    counts : GPUTexture
        R32UI, one row.
    """

    rows: int
    culls: bool
    states: object
    keys: object
    totals: object
    counts: object

    @property
    def kinds(self):
        """Number of segments of `keys` for masks, one a size."""
        return kinds(self.culls)

    def pair_segment(self, number):
        """Return the first row of the keys for pairs of a group of instances; -1: of clusters."""
        return (self.kinds + 1 + number) * self.rows


def kinds(culls):
    """Return how many segments of `keys` are for masks; masks for comparison have their own."""
    return SIZES if culls else 2 * SIZES


def segments(groups, culls):
    """Return how many segments the keys have for so many groups of instances."""
    return kinds(culls) + 1 + groups


def mark_sizes(sources, count, parameters, tables):
    """Mark the sources that need a mask by its size, and count the sources by state.

    Parameters
    ----------
    sources : GPUTexture
    count : int
    parameters : GPUUniformBuf
    tables : CullingTables
    """
    shader = compile_shader(_KEYS)
    shader.bind()
    shader.uniform_sampler("sources_tx", sources)
    shader.uniform_sampler("states_tx", tables.states)
    shader.image("keys_img", tables.keys)
    shader.image("counts_img", tables.counts)
    shader.uniform_block("visibility_buf", parameters)
    shader.uniform_int("count", count)
    shader.uniform_int("rows", tables.rows)
    shader.uniform_int("kinds", tables.kinds)
    dispatch(shader, tables.rows * COLUMNS // _THREADS, 1)


def scan(tables):
    """Turn `keys` into prefix sums over the whole table."""
    prefix_sums.add_up(tables.keys, tables.totals)


def place_tiles(sources, count, parameters, layout, kind, tables, tiles, masked):
    """Write the final state of every source, and place the masks in the atlas.

    Parameters
    ----------
    sources : GPUTexture
    count : int
    parameters, layout : GPUUniformBuf
        `VisibilityParams`, `TileLayout`.
    kind : int
        Of sources that need a mask: 2 have one, 3 are tested in the splat.
    tables : CullingTables
        After `scan`.
    tiles, masked : GPUTexture
        RGBA32F, as large as the list.
    """
    shader = compile_shader(_TILES)
    shader.bind()
    shader.uniform_sampler("sources_tx", sources)
    shader.uniform_sampler("states_tx", tables.states)
    shader.uniform_sampler("keys_tx", tables.keys)
    shader.uniform_sampler("totals_tx", tables.totals)
    shader.image("tiles_img", tiles)
    shader.image("masked_img", masked)
    shader.uniform_block("visibility_buf", parameters)
    shader.uniform_block("layout_buf", layout)
    shader.uniform_int("count", count)
    shader.uniform_int("rows", tables.rows)
    shader.uniform_int("kind", kind)
    shader.uniform_int("kinds", tables.kinds)
    dispatch(shader, -(-count // _THREADS), 1)


def cull_masks(count, masks, tiles, counts):
    """Drop the sources whose mask hides everything, and the masks that hide nothing.

    Parameters
    ----------
    count : int
    masks : GPUTexture
        The atlas.
    tiles : GPUTexture
        Of `place_tiles`; the sources are dropped, or have no mask any more.
    counts : GPUTexture
        Of the `CullingTables`.
    """
    shader = compile_shader(_MASKS)
    shader.bind()
    shader.uniform_sampler("masks_tx", masks)
    shader.image("tiles_img", tiles)
    shader.image("counts_img", counts)
    shader.uniform_int("count", count)
    dispatch(shader, -(-count // _THREADS), 1)
