"""Occluders that meet the cone of rays from a highlight to the lens (methods 10).

Opaque triangles are found in clusters, by trees of bounding boxes (see `engine.drawing.occluders`);
transparent surfaces by the bounding boxes of their instances. Occluders outside of every cone are
culled; the pairs of source and cluster that are left are rasterised into visibility masks.

References
----------
Jeong et al., TVCG 2020, section 4.3.3.
"""

from dataclasses import dataclass

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from .culling import COUNT_GROUPS, COUNT_PAIRS, VISIBILITY_PARAMS
from .prefix_sums import COLUMNS

# Triangles of a cluster, and their corners.
CLUSTER = 8
CLUSTER_CORNERS = 3 * CLUSTER
# Clusters in a row of the texture of triangles; texels for each part in the table of parts.
CLUSTERS_PER_ROW = 128
PART_TEXELS = 2

CLUSTER_DEFINES = (
    ("CLUSTER_CORNERS", str(CLUSTER_CORNERS)),
    ("CLUSTERS_PER_ROW", str(CLUSTERS_PER_ROW)),
    ("PART_TEXELS", str(PART_TEXELS)),
)

_THREADS = 64
_TABLES = ("part_boxes", "parts", "shapes", "boxes", "corners")


@dataclass(frozen=True, eq=False)
class GroupRange:
    """Instances of one transparent mesh, each tested by its bounding box.

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


@dataclass(frozen=True, eq=False)
class ConeScene:
    """Sources, and the occluders that their cones are tested against.

    Parameters
    ----------
    sources : GPUTexture
        First texture of the list.
    count : int
    parameters : GPUUniformBuf
        `VisibilityParams`.
    occluders : engine.drawing.occluders.Occluders
    instances : GPUTexture
        The instance table.
    groups : sequence of GroupRange
    culls : bool
        False: sources whose visibility is decided already are tested, too, for comparison.
    """

    sources: object
    count: int
    parameters: object
    occluders: object
    instances: object
    groups: tuple
    culls: bool = True


@variants(group=(False, True), work=("COUNT", "FILL", "EDGES"))
def _info(group, work):
    """Return a variant: ``COUNT``, ``FILL`` or ``EDGES``."""
    samplers = [("FLOAT_2D", "sources_tx"), ("FLOAT_2D", "instances_tx")]
    if not group:
        samplers += [("FLOAT_2D", f"{name}_tx") for name in _TABLES]
    images = []
    constants = [("INT", "count")]
    constants.append(("IVEC4", "extent") if group else ("INT", "parts"))
    constants += [("VEC4", "box_low"), ("VEC4", "box_high")] * group
    if work == "FILL":
        samplers += [("FLOAT_2D", "states_tx"), ("UINT_2D", "keys_tx"), ("UINT_2D", "totals_tx")]
    else:
        images.append(("RGBA32F", "FLOAT_2D", "states_img", ("READ", "WRITE")))
    if work == "COUNT":
        images.append(("R32UI", "UINT_2D", "keys_img", ("WRITE",)))
        images.append(("R32UI", "UINT_2D", "counts_img", ("READ", "WRITE")))
    if work != "EDGES":
        constants.append(("INT", "culls"))
        constants += [("INT", "segment")] * (not group)
        if work == "FILL" or not group:
            images.append(("RGBA32F", "FLOAT_2D", "pairs_img", ("WRITE",)))
            constants.append(("IVEC2", "window"))
    stem = "bokeh_cones_groups" if group else "bokeh_cones"
    return ShaderInfo(
        name=f"aplanat_{stem}",
        compute=shader_source.load(f"passes/visibility/{stem}_comp.glsl"),
        typedefs=VISIBILITY_PARAMS.source,
        samplers=tuple(samplers),
        images=tuple(images),
        uniforms=(("VisibilityParams", "visibility_buf"),),
        push_constants=tuple(constants),
        defines=(
            ("SOURCE_COLUMNS", str(COLUMNS)),
            *CLUSTER_DEFINES,
            ("COUNT_PAIRS", str(COUNT_PAIRS)),
            (work, "1"),
        ),
        local_size=(_THREADS, 1, 1),
    )


def find_edges(scene, tables):
    """Mark sources as undecided again that an occluder outside the layers' raster may hide.

    Parameters
    ----------
    scene : ConeScene
    tables : passes.visibility.culling.CullingTables
    """
    for number in range(-1, len(scene.groups)):
        shader = _bind(scene, number, tables, "EDGES")
        shader.image("states_img", tables.states)
        dispatch(shader, tables.rows * COLUMNS // _THREADS, 1)


def count_pairs(scene, tables, pairs):
    """Count the occluders in the cone of each undecided source; without any it is fully visible.

    Parameters
    ----------
    scene : ConeScene
    tables : passes.visibility.culling.CullingTables
    pairs : GPUTexture
        RGBA32F, `COLUMNS` wide: gets pairs of source and cluster in any order, as many as it has
        room for.
    """
    for number in range(-1, len(scene.groups)):
        shader = _bind(scene, number, tables, "COUNT")
        shader.image("states_img", tables.states)
        shader.image("keys_img", tables.keys)
        shader.image("counts_img", tables.counts)
        if number < 0:
            shader.image("pairs_img", pairs)
            shader.uniform_int("window", (0, room_of(pairs)))
        dispatch(shader, tables.rows * COLUMNS // _THREADS, 1)


def fill_pairs(scene, number, tables, pairs, window):
    """Write pairs that `count_pairs` has counted, after `passes.visibility.culling.scan`.

    Parameters
    ----------
    scene : ConeScene
    number : int
        Which of the groups; -1 for clusters.
    tables : passes.visibility.culling.CullingTables
    pairs : GPUTexture
        RGBA32F: source, row of the instance table, cluster.
    window : tuple of 2 int
        First pair and number of pairs to write, by their prefix sums.
    """
    shader = _bind(scene, number, tables, "FILL")
    shader.uniform_sampler("states_tx", tables.states)
    shader.uniform_sampler("keys_tx", tables.keys)
    shader.uniform_sampler("totals_tx", tables.totals)
    shader.uniform_int("window", window)
    shader.image("pairs_img", pairs)
    dispatch(shader, tables.rows * COLUMNS // _THREADS, 1)


def room_of(pairs):
    """Return how many pairs fit into a texture."""
    return pairs.width * pairs.height


def _bind(scene, number, tables, work):
    shader = compile_shader(_info(number >= 0, work))
    shader.bind()
    shader.uniform_sampler("sources_tx", scene.sources)
    shader.uniform_sampler("instances_tx", scene.instances)
    segment = tables.pair_segment(number)
    if number < 0:
        for name in _TABLES:
            shader.uniform_sampler(f"{name}_tx", getattr(scene.occluders, name))
        shader.uniform_int("parts", scene.occluders.part_boxes_count)
    else:
        group = scene.groups[number]
        shader.uniform_int("extent", (group.first, group.last, segment, COUNT_GROUPS + number))
        shader.uniform_float("box_low", (*map(float, group.box[0]), 0.0))
        shader.uniform_float("box_high", (*map(float, group.box[1]), 0.0))
    shader.uniform_block("visibility_buf", scene.parameters)
    shader.uniform_int("count", scene.count)
    if work != "EDGES":
        shader.uniform_int("culls", int(scene.culls))
        if number < 0:
            shader.uniform_int("segment", segment)
    return shader
