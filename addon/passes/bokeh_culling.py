"""Which highlights need a mask of what hides them from the lens, and which do not (methods 10).

A test leaves a highlight out (its disc is outside the frame, nothing of the lens sees it) or finds
that it is seen whole (no surface of the peeled layers before it, no triangles in its cone). Only
what is decided beyond doubt changes its way: the picture stays the same.

The results lie in tables as the list of highlights does, `prefix_sums.COLUMNS` columns wide.

References
----------
Jeong et al., TVCG 2020, section 4.3; Decoret, *N-buffers for efficient depth map query*, EG 2005.
"""

from dataclasses import dataclass

from ..device import shader_source
from ..device.shaders import ShaderInfo, compile_shader, dispatch
from ..device.uniform_block import UniformStruct
from . import prefix_sums
from .prefix_sums import COLUMNS

VISIBILITY_PARAMS = UniformStruct("shared/visibility_params.glsl", "VisibilityParams")
TILE_LAYOUT = UniformStruct("shared/tile_layout.glsl", "TileLayout")

# Must agree with engine/occluders.py.
CLUSTER_CORNERS = 192
CLUSTERS_PER_ROW = 16

# Masks have sides of this many texels times powers of two.
LEAST_SIDE = 8
SIZES = 6

# Places in the table of counts: sources by state (see lib/source_lib.glsl), masks by size, texels
# times steps of casting rays, pairs of source and cluster, pairs of source and instance of a group.
STATES = {"outside": (1,), "hidden": (2,), "visible": (3, 6), "masked": (4,), "free": (5,)}
COUNT_SIZES = 8
COUNT_WORK = 16
COUNT_PAIRS = 17
COUNT_GROUPS = 18

_THREADS = 64
_GROUP = 8

_DEFINES = (("SOURCE_COLUMNS", str(COLUMNS)),)

_BOUNDS = ShaderInfo(
    name="aplanat_bokeh_bounds",
    compute=shader_source.load("passes/bokeh_culling_bounds_comp.glsl"),
    samplers=(("FLOAT_2D", "layers_tx"), ("FLOAT_2D", "opacity_tx")),
    images=(("RGBA32F", "FLOAT_2D_ARRAY", "bounds_img", ("READ", "WRITE")),),
    push_constants=(("INT", "level"), ("INT", "cell")),
    local_size=(_GROUP, _GROUP, 1),
)

_CULL = ShaderInfo(
    name="aplanat_bokeh_culling",
    compute=shader_source.load("passes/bokeh_culling_comp.glsl"),
    typedefs=VISIBILITY_PARAMS.source,
    samplers=(
        ("FLOAT_2D", "sources_tx"),
        ("FLOAT_2D", "layers_tx"),
        ("FLOAT_2D_ARRAY", "bounds_tx"),
    ),
    images=(("RGBA32F", "FLOAT_2D", "states_img", ("WRITE",)),),
    uniforms=(("VisibilityParams", "visibility_buf"),),
    push_constants=(("INT", "count"), ("INT", "cell"), ("INT", "culls")),
    defines=_DEFINES,
    local_size=(_THREADS, 1, 1),
)

_KEYS = ShaderInfo(
    name="aplanat_bokeh_keys",
    compute=shader_source.load("passes/bokeh_culling_keys_comp.glsl"),
    typedefs=VISIBILITY_PARAMS.source,
    samplers=(("FLOAT_2D", "states_tx"),),
    images=(
        ("R32UI", "UINT_2D", "keys_img", ("WRITE",)),
        ("R32UI", "UINT_2D", "counts_img", ("READ", "WRITE")),
    ),
    uniforms=(("VisibilityParams", "visibility_buf"),),
    push_constants=(("INT", "count"), ("INT", "rows")),
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
    compute=shader_source.load("passes/bokeh_culling_tiles_comp.glsl"),
    typedefs=VISIBILITY_PARAMS.source + TILE_LAYOUT.source,
    samplers=(("FLOAT_2D", "states_tx"), ("UINT_2D", "keys_tx"), ("UINT_2D", "totals_tx")),
    images=(
        ("RGBA32F", "FLOAT_2D", "tiles_img", ("WRITE",)),
        ("RGBA32F", "FLOAT_2D", "masked_img", ("WRITE",)),
    ),
    uniforms=(("TileLayout", "layout_buf"),),
    push_constants=(("INT", "count"), ("INT", "rows"), ("INT", "kind")),
    defines=_DEFINES,
    local_size=(_THREADS, 1, 1),
)


def _cone_info(group, fill):
    samplers = [("FLOAT_2D", "sources_tx"), ("FLOAT_2D", "instances_tx")]
    if not group:
        samplers += [("FLOAT_2D", f"{name}_tx") for name in ("boxes", "parts", "shapes", "corners")]
    if fill:
        samplers += [("FLOAT_2D", "states_tx"), ("UINT_2D", "keys_tx"), ("UINT_2D", "totals_tx")]
        images = [("RGBA32F", "FLOAT_2D", "pairs_img", ("WRITE",))]
    else:
        images = [
            ("RGBA32F", "FLOAT_2D", "states_img", ("READ", "WRITE")),
            ("R32UI", "UINT_2D", "keys_img", ("WRITE",)),
            ("R32UI", "UINT_2D", "counts_img", ("READ", "WRITE")),
        ]
    constants = [("INT", "count"), ("IVEC4", "extent")]
    constants.append(("IVEC2", "window") if fill else ("IVEC2", "culls"))
    constants += [("VEC4", "box_low"), ("VEC4", "box_high")] * group
    return ShaderInfo(
        name="aplanat_bokeh_cone",
        compute=shader_source.load("passes/bokeh_culling_cone_comp.glsl"),
        typedefs=VISIBILITY_PARAMS.source,
        samplers=tuple(samplers),
        images=tuple(images),
        uniforms=(("VisibilityParams", "visibility_buf"),),
        push_constants=tuple(constants),
        defines=(
            *_DEFINES,
            ("COUNT_PAIRS", str(COUNT_PAIRS)),
            ("CLUSTERS_PER_ROW", str(CLUSTERS_PER_ROW)),
            ("CLUSTER_CORNERS", str(CLUSTER_CORNERS)),
            *[("GROUP", "1")] * group,
            *[("FILL", "1")] * fill,
        ),
        local_size=(_THREADS, 1, 1),
    )


@dataclass(frozen=True, eq=False)
class GroupRange:
    """Instances of one mesh that are tested as wholes.

    Parameters
    ----------
    first, last : int
        Rows of the instance table.
    box : ndarray of shape (2, 3)
        Of the mesh, in object space.
    """

    first: int
    last: int
    box: object


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


def cull(sources, count, parameters, layers, bounds, cell, culls, states):
    """Decide by the peeled layers which sources need a mask.

    Parameters
    ----------
    sources : GPUTexture
        First texture of the list.
    count : int
    parameters : GPUUniformBuf
        `VisibilityParams`.
    layers, bounds : GPUTexture
    cell : int
    culls : bool
        False leaves every source undecided, for comparison.
    states : GPUTexture
        RGBA32F, as large as the list; gets what was found.
    """
    shader = compile_shader(_CULL)
    shader.bind()
    shader.uniform_sampler("sources_tx", sources)
    shader.uniform_sampler("layers_tx", layers)
    shader.uniform_sampler("bounds_tx", bounds)
    shader.image("states_img", states)
    shader.uniform_block("visibility_buf", parameters)
    shader.uniform_int("count", count)
    shader.uniform_int("cell", cell)
    shader.uniform_int("culls", int(culls))
    dispatch(shader, -(-count // _THREADS), 1)


def count_pairs(sources, count, parameters, occluders, instances, groups, culls, tables):
    """Count what meets the cones of the undecided sources; those of nothing are seen whole.

    Parameters
    ----------
    sources : GPUTexture
    count : int
    parameters : GPUUniformBuf
    occluders : engine.occluders.Occluders
    instances : GPUTexture
        The instance table.
    groups : sequence of GroupRange
    culls : tuple of 2 bool
        False keeps every source undecided, for comparison; and whether those that no surface of the
        layers lies before are tested against the triangles, too.
    tables : CullingTables
    """
    for number in range(-1, len(groups)):
        shader = _cone_shader(
            sources, count, parameters, occluders, instances, groups, number, tables, False
        )
        shader.uniform_int("culls", tuple(map(int, culls)))
        shader.image("states_img", tables.states)
        shader.image("keys_img", tables.keys)
        shader.image("counts_img", tables.counts)
        dispatch(shader, tables.rows * COLUMNS // _THREADS, 1)


def fill_pairs(
    sources, count, parameters, occluders, instances, groups, number, tables, pairs, window
):
    """Write pairs that `count_pairs` has counted, after `scan`.

    Parameters
    ----------
    sources, count, parameters, occluders, instances, groups, tables
        As for `count_pairs`.
    number : int
        Which of the groups; -1 for clusters.
    pairs : GPUTexture
        RGBA32F: source, row of the instance table, cluster.
    window : tuple of 2 int
        Which of all prefix sums' places: first and number.
    """
    shader = _cone_shader(
        sources, count, parameters, occluders, instances, groups, number, tables, True
    )
    shader.uniform_sampler("states_tx", tables.states)
    shader.uniform_sampler("keys_tx", tables.keys)
    shader.uniform_sampler("totals_tx", tables.totals)
    shader.uniform_int("window", window)
    shader.image("pairs_img", pairs)
    dispatch(shader, tables.rows * COLUMNS // _THREADS, 1)


def _cone_shader(sources, count, parameters, occluders, instances, groups, number, tables, fill):
    shader = compile_shader(_cone_info(number >= 0, fill))
    shader.bind()
    shader.uniform_sampler("sources_tx", sources)
    shader.uniform_sampler("instances_tx", instances)
    segment = (SIZES + 1 + number) * tables.rows
    if number < 0:
        for name in ("boxes", "parts", "shapes", "corners"):
            shader.uniform_sampler(f"{name}_tx", getattr(occluders, name))
        extent = (occluders.count, 0, segment, COUNT_PAIRS)
    else:
        group = groups[number]
        extent = (group.first, group.last, segment, COUNT_GROUPS + number)
        shader.uniform_float("box_low", (*map(float, group.box[0]), 0.0))
        shader.uniform_float("box_high", (*map(float, group.box[1]), 0.0))
    shader.uniform_block("visibility_buf", parameters)
    shader.uniform_int("count", count)
    shader.uniform_int("extent", extent)
    return shader


@dataclass(frozen=True, eq=False)
class CullingTables:
    """What the tests write.

    Parameters
    ----------
    rows : int
        Of the list of sources.
    states : GPUTexture
        RGBA32F, as large as the list.
    keys : GPUTexture
        R32UI, `segments` times as high.
    totals : GPUTexture
        R32UI, a texel for each row of `keys`.
    counts : GPUTexture
        R32UI, one row.
    """

    rows: int
    states: object
    keys: object
    totals: object
    counts: object


def segments(groups):
    """Return how many segments the keys have for so many groups of instances."""
    return SIZES + 1 + groups


def mark_sizes(count, parameters, tables):
    """Mark the sources that need a mask by its size, and count the sources by state.

    Parameters
    ----------
    count : int
    parameters : GPUUniformBuf
    tables : CullingTables
    """
    shader = compile_shader(_KEYS)
    shader.bind()
    shader.uniform_sampler("states_tx", tables.states)
    shader.image("keys_img", tables.keys)
    shader.image("counts_img", tables.counts)
    shader.uniform_block("visibility_buf", parameters)
    shader.uniform_int("count", count)
    shader.uniform_int("rows", tables.rows)
    dispatch(shader, tables.rows * COLUMNS // _THREADS, 1)


def scan(tables):
    """Turn the keys into prefix sums over all of them."""
    prefix_sums.add_up(tables.keys, tables.totals)


def place_tiles(count, layout, kind, tables, tiles, masked):
    """Say for every source what becomes of it, and give the masks their places.

    Parameters
    ----------
    count : int
    layout : GPUUniformBuf
        `TileLayout`.
    kind : int
        Of sources that need a mask: 2 have one, 3 are tested in the splat.
    tables : CullingTables
        After `scan`.
    tiles, masked : GPUTexture
        RGBA32F, as large as the list.
    """
    shader = compile_shader(_TILES)
    shader.bind()
    shader.uniform_sampler("states_tx", tables.states)
    shader.uniform_sampler("keys_tx", tables.keys)
    shader.uniform_sampler("totals_tx", tables.totals)
    shader.image("tiles_img", tiles)
    shader.image("masked_img", masked)
    shader.uniform_block("layout_buf", layout)
    shader.uniform_int("count", count)
    shader.uniform_int("rows", tables.rows)
    shader.uniform_int("kind", kind)
    dispatch(shader, -(-count // _THREADS), 1)
