"""Visibility of a frame's highlights from the lens: culling, and masks (methods 10, 11).

Culling finds the sources that need no mask. The others get a mask over the lens in an atlas, drawn
by projecting the scene from the source (RASTER) or by rays through depth-peeled layers (WARP), or
their rays are cast by the splat, pixel by pixel (SPLAT).

The cost of the layers grows with the triangles of the scene, however few highlights there are; so
RASTER culls by triangles alone. AUTO tests highlights against triangles first and rasterises the
masks from the clusters that it meets, unless the counts say that layers and rays are less work.
Where there are very many highlights, it uses the layers without testing triangles.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...device import geometry, state
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ...passes.visibility import cones, culling, visibility_raster, visibility_warp
from ...passes.visibility.prefix_sums import COLUMNS
from .occluder_layers import cull_by_layers, draw_layers, number_of, texels_per_pixel
from .plan import (
    LARGEST_ATLAS,
    VisibilityCounts,
    choose,
    lay_out,
    lay_out_more,
    layers_cost,
    note,
    visibility_params,
)
from .scene_occluders import SceneOccluders

__all__ = ("BokehVisibility", "SceneOccluders", "Visibility", "VisibilityCounts", "lay_out")

# Pairs of source and cluster that are listed at once, and least room for them.
_WINDOW = 1 << 20
_LEAST_PAIRS = 1 << 18
# Most sources that are tested against triangles; more are left to the layers alone, whose cost a
# source falls with the size of its mask.
_MOST_CONES = 1 << 17
# Number of sources from which on the atlas is smaller, its texels then, and those of a draft's.
_MANY = 1 << 15
_ATLAS_OF_MANY = 1 << 23
_DRAFT_ATLAS = 1 << 19

MASKED, IN_SPLAT = 2, 3


@dataclass(frozen=True, eq=False)
class Visibility:
    """Visibility of sources as textures that the splat reads.

    Parameters
    ----------
    tiles : GPUTexture
        A texel for each source: place and side of its mask, kind (see
        lib/bokeh/visibility_lib.glsl).
    masks : GPUTexture
        The atlas of masks.
    layers, opacity : GPUTexture or None
        The depth-peeled layers, if there are any, for rays that the splat casts.
    states : GPUTexture
        State of each source: end of its rays, blur by its occluders' parallax (see
        passes/visibility/bokeh_culling_comp.glsl).
    parameters : GPUUniformBuf
        `VisibilityParams`.
    counts : VisibilityCounts
    bytes : int
        Memory of its textures.
    """

    tiles: object
    masks: object
    layers: object
    opacity: object
    states: object
    parameters: object
    counts: VisibilityCounts
    bytes: int


class BokehVisibility:
    """Finds the visibility of a frame's highlights.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    occluders : SceneOccluders
    buffers : SceneBuffers
    reach : float
        Extent of a disc in units of its radius.
    """

    def __init__(self, plan, occluders, buffers, reach=1.0):
        self._plan = plan
        self._occluders = occluders
        self._buffers = buffers
        self._captured = bool(plan.layered and plan.layered.stack)
        self._fine = 1 if self._captured else texels_per_pixel(plan.bokeh)
        self._values = visibility_params(plan, self._fine, reach)
        self._parameters = uniform_buffer(culling.VISIBILITY_PARAMS.pack(**self._values))

    def find(self, sources, count, drawing, targets, method=None, culls=True):
        """Cull the sources, and make the masks of those that need one.

        Parameters
        ----------
        sources : GPUTexture
            First texture of the list of highlights.
        count : int
        drawing : SceneDrawing
            Aimed at the frame.
        targets : list
            Gets the `Targets` of the result, for the caller to release.
        method : {'AUTO', 'RASTER', 'WARP', 'SPLAT'}, optional
            Default: the plan's.
        culls : bool
            False gives every source a mask, for comparison, also those that are culled.

        Returns
        -------
        Visibility
        """
        method = method or self._plan.bokeh.settings.visibility
        if self._captured and method != "SPLAT":
            # There are no triangles.
            method = "WARP"
        if method == "AUTO" and count > _MOST_CONES:
            method = "WARP"
        search = _Search(self, sources, count, drawing, culls)
        try:
            return search.run(method, targets)
        finally:
            search.release()


class _Search:
    """One run of `BokehVisibility.find`."""

    def __init__(self, owner, sources, count, drawing, culls):
        self._plan = owner._plan
        self._occluders = owner._occluders
        self._buffers = owner._buffers
        self._fine = owner._fine
        self._captured = owner._captured
        self._values = owner._values
        self._parameters = owner._parameters
        self._sources = sources
        self._count = count
        self._drawing = drawing
        self._culls = culls
        self._own = []
        self._raster = None

    def release(self):
        """Release the intermediate lists."""
        for targets in self._own:
            targets.release()

    def run(self, method, targets):
        """Find the visibility; parameters and result as of `BokehVisibility.find`."""
        rows = max(1, -(-self._count // COLUMNS))
        specs = [TargetSpec(n, "RGBA32F") for n in ("tiles", "masked", "states")]
        lists = self._lists = Targets(COLUMNS, rows, specs)
        targets.append(lists)
        self._make_tables(rows)
        if method in {"AUTO", "RASTER"}:
            counts = self._test_by_triangles()
            counts.method = choose(counts, method, self._layers_cost())
            if counts.method == "WARP":
                counts = replace(self._test_by_layers(again=True), method="WARP")
        else:
            counts = self._test_by_layers()
            counts.method = method if counts.masked else ""
        if self._raster and not self._captured:
            targets.append(self._raster)
        base, whole = self._lay_out(counts)
        layout = uniform_buffer(whole.packed())
        culling.scan(self._tables)
        kind = IN_SPLAT if counts.method == "SPLAT" else MASKED
        culling.place_tiles(
            self._sources,
            self._count,
            self._parameters,
            layout,
            kind,
            self._tables,
            lists["tiles"],
            lists["masked"],
        )
        masks = Targets(whole.width, whole.height, [TargetSpec("masks", self._format())])
        targets.append(masks)
        self._draw_masks(counts, masks.framebuffer("masks"), base, whole)
        if counts.texels and self._culls:
            tables = (masks["masks"], lists["tiles"], self._tables.counts)
            culling.cull_masks(self._count, *tables)
        # What is given back now is given back only after the device has read it.
        self._note_masks(counts)
        held = [*self._own, lists, masks, *([self._raster] if self._raster else [])]
        return Visibility(
            tiles=lists["tiles"],
            masks=masks["masks"],
            layers=self._raster and self._raster["layers"],
            opacity=self._raster and self._raster["opacity"],
            states=lists["states"],
            parameters=self._parameters,
            counts=counts,
            bytes=sum(each.bytes for each in held),
        )

    def _make_tables(self, rows):
        groups = len(self._occluders.groups)
        height = culling.segments(groups, self._culls) * rows
        width = culling.COUNT_GROUPS + groups
        tables = Targets(
            COLUMNS,
            height,
            [
                TargetSpec("keys", "R32UI"),
                TargetSpec("totals", "R32UI", size=(COLUMNS, -(-height // COLUMNS))),
                TargetSpec("counts", "R32UI", size=(width, 1)),
            ],
        )
        self._own.append(tables)
        self._tables = culling.CullingTables(
            rows,
            self._culls,
            self._lists["states"],
            tables["keys"],
            tables["totals"],
            tables["counts"],
        )
        self._pairs = None

    def _scene(self):
        return cones.ConeScene(
            self._sources,
            self._count,
            self._parameters,
            self._occluders.opaque,
            self._buffers.instances,
            self._occluders.groups,
            self._culls,
        )

    def _test_by_triangles(self):
        self._clear_counts()
        args = (self._sources, self._count, self._parameters)
        culling.cull_frame(*args, self._tables.states)
        room = max(_LEAST_PAIRS, min(self._buffers.expected_pairs, _WINDOW))
        cones.count_pairs(self._scene(), self._tables, self._pair_list(room))
        culling.mark_sizes(*args, self._tables)
        return self._read_counts()

    def _test_by_layers(self, again=False):
        plan = self._plan
        self._clear_counts()
        if self._captured:
            self._raster = self._buffers.captured.occluders(plan)
        else:
            self._raster = draw_layers(plan, self._drawing, self._buffers.instances, self._fine)
        args = (self._sources, self._count, self._parameters)
        self._own.append(cull_by_layers(*args, self._raster, again, self._tables.states))
        # Of a captured picture nothing is known outside its raster.
        if self._count <= _MOST_CONES and not plan.bokeh.draft and not self._captured:
            cones.find_edges(self._scene(), self._tables)
            if not again:
                room = _LEAST_PAIRS
                cones.count_pairs(self._scene(), self._tables, self._pair_list(room))
        culling.mark_sizes(*args, self._tables)
        return self._read_counts()

    def _pair_list(self, room):
        pairs = Targets(COLUMNS, -(-room // COLUMNS), [TargetSpec("pairs", "RGBA32F")])
        self._own.append(pairs)
        self._pairs = pairs["pairs"]
        return self._pairs

    def _clear_counts(self):
        self._tables.counts.clear(format="UINT", value=(0,))

    def _read_counts(self):
        self._found = np.asarray(self._tables.counts.read()).ravel().astype(np.int64)
        return note(self._found, self._room())

    def _note_masks(self, counts):
        found = np.asarray(self._tables.counts.read()).ravel()
        counts.whole = int(found[culling.COUNT_WHOLE])
        counts.empty = int(found[culling.COUNT_EMPTY])
        counts.visible += counts.whole
        counts.hidden += counts.empty
        counts.masked -= counts.whole + counts.empty

    def _layers_cost(self):
        bokeh = self._plan.bokeh
        texels = bokeh.width * bokeh.height * self._fine**2
        return layers_cost(self._drawing.full_detail, texels, number_of(bokeh))

    def _lay_out(self, counts):
        """Return the layout of the masks, and the same with masks for comparison."""
        drawn = self._found[culling.COUNT_SIZES :][: self._tables.kinds]
        if counts.method not in {"RASTER", "WARP"}:
            drawn = drawn * 0
        first, more = drawn[: culling.SIZES], drawn[culling.SIZES :]
        base = lay_out(first, self._room())
        counts.texels = int((first * base.sizes[:, 2] ** 2).sum())
        if self._culls:
            return base, base
        counts.masked = int(drawn.sum())
        return base, lay_out_more(base, int(first.sum()), more)

    def _room(self):
        """Return how many texels masks may take."""
        if self._plan.bokeh.draft:
            return _DRAFT_ATLAS
        return LARGEST_ATLAS if self._count <= _MANY else _ATLAS_OF_MANY

    def _format(self):
        # More than 8 bits: transmittances of several surfaces are multiplied.
        return "R16F" if self._occluders.groups or self._captured else "R8"

    def _draw_masks(self, counts, atlas, base, whole):
        with atlas.bind():
            atlas.clear(color=(1.0, 1.0, 1.0, 1.0))
        draw = {"WARP": self._warp, "RASTER": self._rasterise}.get(counts.method)
        if draw is None:
            return
        # Rasterisation depends on the size of the atlas in the last bits. Masks for comparison have
        # a part of their own, so that the others are the same without them.
        with atlas.bind(), state.confined(0, 0, base.width, base.height):
            draw(counts, atlas, uniform_buffer(base.packed()))
        if whole is not base:
            above = (0, base.height, whole.width, whole.height - base.height)
            with atlas.bind(), state.scissored(*above):
                draw(counts, atlas, uniform_buffer(whole.packed()))

    def _warp(self, counts, _, layout):
        tables = {name: self._lists[name] for name in ("masked", "tiles", "states")}
        tables["sources"] = self._sources
        tables |= {name: self._raster[name] for name in ("layers", "opacity")}
        square = geometry.square_batch()
        visibility_warp.draw_masks(square, counts.masked, tables, self._parameters, layout)

    def _rasterise(self, counts, atlas, layout):
        shared = {
            "sources": self._sources,
            "tiles": self._lists["tiles"],
            "instances": self._buffers.instances,
        }
        batch = geometry.numbered_batch(visibility_raster.BATCH_CORNERS)
        self._buffers.expected_pairs = counts.pairs + counts.pairs // 4
        # The pairs' prefix sums begin behind those of the masks.
        first = counts.masked
        numbers = [counts.pairs, *self._found[culling.COUNT_GROUPS :].tolist()]
        listed = counts.pairs <= cones.room_of(self._pairs)
        for number, total in enumerate(numbers, start=-1):
            for start in range(0, total, _WINDOW):
                drawn = min(total - start, _WINDOW)
                if number >= 0 or not listed:
                    if drawn > cones.room_of(self._pairs):
                        self._pair_list(drawn)
                    window = (first + start, drawn)
                    cones.fill_pairs(self._scene(), number, self._tables, self._pairs, window)
                tables = {**shared, "pairs": self._pairs}
                with atlas.bind():
                    if number < 0:
                        tables["corners"] = self._occluders.opaque.corners
                        visibility_raster.draw_clusters(
                            batch, drawn, tables, self._parameters, layout
                        )
                    else:
                        draws = self._occluders.draws_of(number)
                        visibility_raster.draw_surfaces(
                            draws, drawn, tables, self._parameters, layout
                        )
            first += total
