"""Clustering of highlights: similar sources are merged into fewer that look the same (methods 9).

Neighbours are merged level by level, as in the reduction of a mip pyramid, but in cells of world
space that stay where they are while the camera moves: which highlights merge does not depend on
how the raster of pixels lies over the scene, so clusters do not flicker. The cells of level l have
sides of ``2^l`` times a share of the circle of confusion in object space; the sources in a cell
become one where that does no visible harm (see `Similarity`), else they go on as they are. Instead
of a horizontal and a vertical pass, each level has two passes whose cells are half a side apart:
sources on both sides of a cell's border meet in the other pass.

A merged source has the summed energy and the mean place of its parts, and the extent of a square
with the variance of their places. Energies are added up as whole numbers: the order of the device's
threads changes no bit, and no energy is lost.

References
----------
Jeong et al., TVCG 2020, section 4.2.2.
"""

from dataclasses import dataclass

import numpy as np

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.targets import Targets, TargetSpec
from ...device.uniform_block import UniformStruct
from ..visibility import culling, prefix_sums
from ..visibility.prefix_sums import COLUMNS

CLUSTER_PARAMS = UniformStruct("shared/cluster_params.glsl", "ClusterParams")

# Most sources that are compared pair by pair.
MOST_PAIRED = 8192

_THREADS = 64
_GROUPS = shader_source.load("passes/bokeh/clusters_groups_comp.glsl")
_STEPS = shader_source.load("passes/bokeh/clusters_comp.glsl")

_TABLE = ("R32UI", "UINT_2D")
_WRITE, _BOTH = ("WRITE",), ("READ", "WRITE")
_SOURCES = (("FLOAT_2D", "a_tx"), ("FLOAT_2D", "b_tx"))


def _tables(*names):
    return tuple(("UINT_2D", name) for name in ("number_tx", *names))


def _info(name, text, samplers, images, defines=(), parameters=True, constants=()):
    return ShaderInfo(
        name=f"aplanat_clusters_{name.lower()}",
        compute=text,
        typedefs=CLUSTER_PARAMS.source * parameters,
        samplers=samplers,
        images=tuple((*_TABLE, *image) if len(image) == 2 else image for image in images),
        uniforms=(("ClusterParams", "cluster_buf"),) * parameters,
        push_constants=constants,
        defines=((name, "1"), ("SOURCE_COLUMNS", str(COLUMNS)), *((d, "1") for d in defines)),
        local_size=(_THREADS, 1, 1),
    )


_LEVEL = (("FLOAT", "level"),)
_CELLS = _info(
    "CELLS",
    _GROUPS,
    _tables() + _SOURCES,
    (("table_img", _BOTH), ("slots_img", _WRITE)),
    constants=(*_LEVEL, ("FLOAT", "shift"), ("INT", "slots_mask")),
)
_NEAREST = _info(
    "NEAREST", _GROUPS, _tables() + _SOURCES, (("nearest_img", _WRITE),), constants=_LEVEL
)
_PAIRS = _info("PAIRS", _GROUPS, _tables("nearest_tx"), (("leaders_img", _WRITE),))
_COUNTS = (("sizes_img", _BOTH), ("starts_img", _BOTH), ("leaders_img", _BOTH))
_COUNT = _info("COUNT", _STEPS, _tables("slots_tx", "table_tx"), _COUNTS, parameters=False)
_COUNT_PAIRS = _info("COUNT", _STEPS, _tables(), _COUNTS, ("WITH_LEADERS",), parameters=False)
_PLACES = ("starts_tx", "totals_tx")
_FILL = _info(
    "FILL",
    _STEPS,
    _tables("leaders_tx", *_PLACES),
    (("cursors_img", _BOTH), ("members_img", _WRITE)),
    ("PLACES",),
    parameters=False,
)
_MERGE = _info(
    "MERGE",
    _STEPS,
    _tables("sizes_tx", "members_tx", *_PLACES),
    (
        ("RGBA32F", "FLOAT_2D", "a_img", _BOTH),
        ("RGBA32F", "FLOAT_2D", "b_img", _BOTH),
        ("merged_img", _WRITE),
    ),
    ("PLACES",),
)
_MARK = _info(
    "MARK",
    _STEPS,
    _tables("leaders_tx", "merged_tx"),
    (("marks_img", _WRITE), ("starts_img", _WRITE)),
    parameters=False,
)
_WRITE_OUT = _info(
    "WRITE",
    _STEPS,
    _tables("marks_tx", *_PLACES) + _SOURCES,
    (
        ("RGBA32F", "FLOAT_2D", "a_out_img", _WRITE),
        ("RGBA32F", "FLOAT_2D", "b_out_img", _WRITE),
        ("number_img", _WRITE),
    ),
    ("PLACES",),
    parameters=False,
)

_SIDE = 8


@variants(layered=(False, True))
def _soften_info(layered):
    names = ("sources", "tiles", "states", "masks", *("layers",) * layered)
    shared = f"shared vec2 blurs[{_SIDE * _SIDE}];\n" * layered
    return ShaderInfo(
        name="aplanat_clusters_soften",
        compute=shader_source.load("passes/bokeh/clusters_soften_comp.glsl"),
        typedefs=culling.VISIBILITY_PARAMS.source + shared,
        samplers=tuple(("FLOAT_2D", f"{name}_tx") for name in names),
        images=(("R16F", "FLOAT_2D", "soft_img", ("WRITE",)),),
        uniforms=(("VisibilityParams", "visibility_buf"),),
        push_constants=(("INT", "count"),),
        defines=(("SOURCE_COLUMNS", str(COLUMNS)), *(("LAYERS", "1"),) * layered),
        local_size=(_SIDE, _SIDE, 1),
    )


@dataclass(frozen=True)
class Similarity:
    """Bounds of similarity within which highlights are merged.

    Parameters
    ----------
    levels : int
        How often; each level has cells of twice the size.
    cell : float
        Side of the cells of level 0 in radii of the circle of confusion.
    extent : float
        How far what is merged may spread, in radii of the circle of confusion.
    harm : float
        How much a merge may change the picture: the brightness of the disc times the square of the
        extent over the radius of the circle of confusion and 8 px.
    pairs : int
        How often those that are nearest to each other are merged, wherever cells part them.
    length : float
        Of a cell along the camera's axis in sides. Long cells hold more, but where the camera turns
        they stay in place no longer.
    """

    levels: int
    cell: float
    extent: float
    harm: float
    pairs: int = 0
    length: float = 1.0


def cluster_params(similarity, view, lens, pixel):
    """Return the bytes of `ClusterParams`.

    Parameters
    ----------
    similarity : Similarity
    view : ndarray of shape (4, 4)
        World to camera space.
    lens : tuple of 4 float
        As in `ViewParams`.
    pixel : float
        Side of a pixel 1 m away (orthographic: anywhere), m.

    Returns
    -------
    bytes
    """
    return CLUSTER_PARAMS.pack(
        world=np.linalg.inv(view) @ np.diag([1.0, 1.0, 1.0 / similarity.length, 1.0]),
        lens=lens,
        cell=(similarity.cell, pixel, 0.0, 0.0),
        limits=(similarity.extent, similarity.harm, 0.0, 0.0),
    )


def cluster(sources, count, parameters, similarity):
    """Merge similar sources.

    Parameters
    ----------
    sources : tuple of 2 GPUTexture
        The list (see `passes.bokeh.highlights`); what it holds is lost.
    count : int
    parameters : GPUUniformBuf
        `ClusterParams`.
    similarity : Similarity

    Returns
    -------
    lists : Targets
        With ``a`` and ``b``, the new list, in the order of the old one.
    count : int
        How many are left.
    unpaired : int
        Number of sources where they were too many to be compared pair by pair; 0 where they were
        compared, or pairwise merging was not asked for.
    """
    rows = -(-count // COLUMNS)
    slots = 1 << int(2 * count - 1).bit_length()
    tables = [TargetSpec(name, "R32UI") for name in ("leaders", "sizes", "starts", "members")]
    tables += [TargetSpec(name, "R32UI") for name in ("slots", "merged", "marks")]
    tables.append(TargetSpec("table", "R32UI", size=(COLUMNS, -(-slots // COLUMNS))))
    tables.append(TargetSpec("totals", "R32UI", size=(COLUMNS, -(-rows // COLUMNS))))
    tables += [TargetSpec(f"number_{k}", "R32UI", size=(1, 1)) for k in (0, 1)]
    out = Targets(COLUMNS, rows, [TargetSpec(name, "RGBA32F") for name in "ab"])
    with (
        Targets(COLUMNS, rows, tables) as tables,
        Targets(COLUMNS, rows, [TargetSpec(name, "RGBA32F") for name in "ab"]) as spare,
    ):
        run = _Run(tables, parameters, rows * COLUMNS // _THREADS, slots)
        tables["number_0"].clear(format="UINT", value=(count,))
        # The last list that is written is `out`.
        lists = [(spare["a"], spare["b"]), (out["a"], out["b"])]
        steps = [
            (level, shift) for level in range(1, similarity.levels + 1) for shift in (0.0, 0.5)
        ]
        cells, unpaired = len(steps), 0
        # None as a level stands for pairwise merging.
        steps += [(similarity.levels, None)] * similarity.pairs
        for done in range(len(steps)):
            if done == cells and run.number() > MOST_PAIRED:
                unpaired = run.number()
                steps[done:] = [steps[0]] * similarity.pairs
            level, shift = steps[done]
            target = lists[(len(steps) - done) % 2]
            run.group(sources, float(level), shift)
            run.merge(sources, target)
            sources = target
        # Also waits until the device has read the tables.
        return out, run.number(), unpaired


def soften(sources, count, visibility, soft):
    """Blur the visibility masks of merged sources by the parallax of their occluders.

    The parts of a merged source see an occluder at different places on the lens.

    Parameters
    ----------
    sources : GPUTexture
        First texture of the list.
    count : int
    visibility : engine.visibility.stage.Visibility
        With masks.
    soft : GPUTexture
        R16F, as large as the atlas; gets the blurred masks.
    """
    layered = visibility.layers is not None
    shader = compile_shader(_soften_info(layered))
    shader.bind()
    shader.uniform_sampler("sources_tx", sources)
    for name in ("tiles", "states", "masks", *("layers",) * layered):
        shader.uniform_sampler(f"{name}_tx", getattr(visibility, name))
    shader.image("soft_img", soft)
    shader.uniform_block("visibility_buf", visibility.parameters)
    shader.uniform_int("count", count)
    dispatch(shader, COLUMNS, -(-count // COLUMNS))


class _Run:
    """The steps of merging, level by level.

    Parameters
    ----------
    tables : Targets
    parameters : GPUUniformBuf
    groups : int
        Of threads that a list takes.
    slots : int
        Of the table of cells.
    """

    def __init__(self, tables, parameters, groups, slots):
        self._tables = tables
        self._parameters = parameters
        self._groups = groups
        self._slots = slots
        self._turn = 0

    def number(self):
        """Return how many sources there are."""
        return int(np.asarray(self._tables[f"number_{self._turn}"].read()).ravel()[0])

    def group(self, sources, level, shift):
        """Find the group of each source, named by the number of its first member."""
        clear = ("sizes", "starts", "merged", "table", "marks")
        for name in clear:
            self._tables[name].clear(format="UINT", value=(0,))
        listed = tuple(zip(("a_tx", "b_tx"), sources, strict=True))
        if shift is not None:
            constants = {"level": level, "shift": shift, "slots_mask": self._slots - 1}
            self._step(_CELLS, listed, constants)
            self._step(_COUNT)
        else:
            self._step(_NEAREST, listed, {"level": level}, nearest_img="slots")
            self._step(_PAIRS, nearest_tx="slots")
            self._step(_COUNT_PAIRS)

    def merge(self, sources, target):
        """Merge the groups whose harm is small enough; the result is in `target`."""
        self._scan()
        self._step(_FILL, cursors_img="marks")
        self._step(_MERGE, tuple(zip(("a_img", "b_img"), sources, strict=True)))
        self._tables["starts"].clear(format="UINT", value=(0,))
        self._step(_MARK)
        self._scan()
        listed = zip(("a_tx", "b_tx"), sources, strict=True)
        written = zip(("a_out_img", "b_out_img"), target, strict=True)
        self._step(_WRITE_OUT, (*listed, *written))
        self._turn = 1 - self._turn

    def _scan(self):
        tables = self._tables
        prefix_sums.add_up(tables["starts"], tables["totals"])

    def _step(self, info, textures=(), constants=None, **renamed):
        given = dict(textures)
        shader = compile_shader(info)
        shader.bind()
        for _, name in info.samplers:
            shader.uniform_sampler(name, given.get(name) or self._table(name, renamed))
        for _, _, name, _ in info.images:
            shader.image(name, given.get(name) or self._table(name, renamed))
        if info.uniforms:
            shader.uniform_block("cluster_buf", self._parameters)
        for name, value in (constants or {}).items():
            shader.uniform_float(name, value) if isinstance(value, float) else shader.uniform_int(
                name, value
            )
        dispatch(shader, self._groups, 1)

    def _table(self, name, renamed):
        own = renamed.get(name, name.rpartition("_")[0])
        if own == "number":
            own = f"number_{self._turn if name == 'number_tx' else 1 - self._turn}"
        return self._tables[own]
