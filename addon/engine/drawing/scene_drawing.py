"""Drawing the surfaces of a scene for one lens sample after another.

Chooses, from the plan, the level of detail of each instance for each lens sample, and the samples
that share a drawing of it.
"""

from contextlib import nullcontext
from dataclasses import replace

import numpy as np

from ...device import state
from ...device.textures import texture_2d
from ...levels.choosing import extents, level_for_sample, world_corners
from ...passes.surface import surface
from ...passes.surface.draw import by_level
from . import culling
from .divided_drawings import DividedDrawings
from .drawing_counts import DrawingCounts
from .glass.glass_drawing import GlassDrawing
from .glass.veils import Veils
from .graded_drawings import GradedDrawings
from .group_levels import GroupLevels
from .light_maps import LightMaps
from .scene_buffers import instance_texels
from .shared_drawings import SharedDrawings


class SceneDrawing:
    """Draws a content's surfaces.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
        Updated to it.
    target : passes.surface.surface_target.SurfaceTarget
    graded : dict
        Graded meshes of earlier frames; see `GradedDrawings`.

    Attributes
    ----------
    counts : DrawingCounts
        Since the frame began.
    target : passes.surface.surface_target.SurfaceTarget
    nearest, farthest : float
        Least and largest depth of any visible instance, m; inf and 0 where there is none.
    levels : ndarray of shape (I,)
        Level of detail of each instance in this frame.
    full_detail : int
        Triangles of all instances at full detail.
    lights : LightMaps
        Of the frame.
    """

    def __init__(self, content, buffers, target, graded):
        self._content = content
        self._buffers = buffers
        self.target = target
        draws = surface.build_draws(content, buffers, target)
        self._draws = [draw for draw in draws if not draw.refracts]
        self._veils = Veils(surface.build_veils(content, buffers, target))
        self.full_detail = sum(
            d.triangles * d.count for d in (*draws, *self._veils.draws) if d.level == 0
        )
        bounds = {uid: mesh.bounds for uid, mesh in buffers.meshes.items()}
        self._spheres = culling.BoundingSpheres(content, bounds)
        self._corners = world_corners(content, bounds)
        self._group_of = np.zeros(len(self._corners), np.int64)
        for number, group in enumerate(content.groups):
            self._group_of[group.first : group.first + group.count] = number
        self._group_levels = GroupLevels(content, buffers)
        self._by_level = by_level(self._draws)
        glass = [draw for draw in draws if draw.refracts]
        self._glass = GlassDrawing(content, buffers, target, glass, self._spheres)
        # Transparent and glowing surfaces differ from sample to sample: they share no drawing.
        self._unshared = {d.group for d in self._draws if d.transparent}
        self._unshared |= {d.group for d in (*self._veils.draws, *glass)}
        self._shared = SharedDrawings("MATTES" in target.defines)
        self._graded = GradedDrawings(content, buffers, graded)
        self._divided = DividedDrawings(content)
        self.lights = LightMaps(content, buffers, self._spheres, self._corners)

    def aim(self, plan, optics=None, highlights=None, part=None):
        """Prepare a frame or a round of it: levels, shared drawings, order of the instances.

        Parameters
        ----------
        plan : FramePlan
        optics : callable, optional
            From a sample, or None for the lens' middle at the reference wavelength, to what is
            bound for it; for a target of `passes.surface.surface_target.in_wavelengths` or
            `through_lens`.
        highlights : passes.bokeh.split_light.SplitLight or None
            For a target that splits light.
        part : tuple of 4 int, optional
            x, y, width, height of the part of the raster that is drawn; default: all of it.
        """
        self._plan = plan
        self._part = part
        self._optics = optics or (lambda _sample: None)
        self._highlights = highlights
        self.counts = DrawingCounts()
        self._seen = self._visible = culling.seen(self._spheres, plan)
        if part is not None:
            self._visible = self._seen & culling.seen(self._spheres, plan, part)
        seen = extents(self._corners, plan.view, plan.chromatic)
        self.nearest = float(seen.nearest[self._seen].min(initial=np.inf))
        self.farthest = float(seen.farthest[self._seen].max(initial=0.0))
        self.levels = self._group_levels.choose(seen, plan)
        self._glass.aim(plan, self._visible, part)
        if self._glass.is_seen:
            # What is blurred may be sharp where it is seen through glass.
            self.levels[:] = 0.0
        self.lights.aim(plan, self._seen, seen)
        whole = np.flatnonzero(self._visible & (self.levels < 1.0))
        self._divided.find(whole, self._group_of, seen.nearest, plan)
        full = self._visible & (self.levels == 0.0)
        full[list(self._divided.rows)] = False
        self._graded.find_among(full, self._group_levels.deepest, self._group_of, plan)
        self._shared.forget()
        if plan.reuse_grid:
            candidates = [
                int(row)
                for row in np.flatnonzero(self._visible)
                if self._group_of[row] not in self._unshared
            ]
            self._shared.find(
                candidates, self._corners, seen, self.levels, self._triangles_of, plan
            )
        self._graded.settle(self._shared.drawings_of)
        # Rows that are drawn on their own, not with their neighbours in the table.
        self._single = sorted({*self._shared.rows, *self._graded.rows, *self._divided.rows})
        self._order_rows()

    def _triangles_of(self, row):
        counts = self._group_levels.triangles[self._group_of[row]]
        return self._graded.triangles(row, counts)

    def _order_rows(self):
        """Sort the rows of each group by level of detail, so that equal levels are neighbours."""
        count = len(self._visible)
        drawn = self._visible.copy()
        drawn[self._single] = False
        lower = np.floor(self.levels)
        change = self.levels - lower
        order = np.arange(count)
        self._rows = []
        for group in self._content.groups:
            rows = np.arange(group.first, group.first + group.count)
            kept = rows[drawn[rows]]
            places = kept
            if len(kept) and np.ptp(self.levels[kept]) > 0.0:
                kept = kept[np.lexsort((change[kept], lower[kept]))]
                order[rows] = np.concatenate([kept, rows[~drawn[rows]]])
                places = group.first + np.arange(len(kept))
            self._rows.append((places, lower[kept], change[kept]))
        # The levels of all groups' rows together, and where each group's begin.
        none = np.zeros(0)
        self._row_levels = np.concatenate([none, *(low + part for _, low, part in self._rows)])
        self._starts = np.cumsum([0, *(len(places) for places, _, _ in self._rows)]).tolist()
        self._listed = {}
        self._table = self._buffers.instances
        self._place = np.arange(count)
        if not np.array_equal(order, self._place):
            instances = self._content.instances
            ordered = replace(
                instances,
                world=instances.world[order],
                cryptomatte_id=instances.cryptomatte_id[order],
                looks=None if instances.looks is None else instances.looks[order],
            )
            self._table = texture_2d(instance_texels(ordered))
            self._place[order] = np.arange(count)
        self._veils.aim(self._spheres.centers[order], self._plan.view)

    def _list(self, draws, index):
        """List the draw calls for a sample, without rows that share a drawing."""
        levels = level_for_sample(self._row_levels, *self._plan.in_round(index))
        ends = zip(self._starts, self._starts[1:], strict=False)
        of_group = [levels[first:end].tobytes() for first, end in ends]
        listed = []
        for draw in draws:
            # Cached: most samples draw a group's rows at the same levels as another sample.
            key = (id(draw), of_group[draw.group])
            if key not in self._listed:
                first, end = self._starts[draw.group : draw.group + 2]
                self._listed[key] = self._runs(draw, levels[first:end] == draw.level)
            listed += self._listed[key]
        return listed

    def _runs(self, draw, chosen):
        places = self._rows[draw.group][0]
        # Between rows of one level only culled rows may be drawn along.
        passing = draw.triangles if chosen.all() else np.inf
        return [
            draw
            if (first, count) == (draw.first, draw.count)
            else replace(draw, first=first, count=count)
            for first, count in culling.runs(places[chosen], passing)
        ]

    def _of_row(self, draws, row, level, index):
        """List the draw calls of one row at a level; `draws`: all draws by group and level."""
        place = int(self._place[row])
        found = draws.get((int(self._group_of[row]), int(level)), ())
        graded = None
        if level == 0:
            graded = self._divided.mesh(row) or self._graded.mesh(row, index)
        if graded is None:
            return [replace(draw, first=place, count=1) for draw in found]
        own = [(draw, *graded.batches[draw.slot]) for draw in found if draw.slot in graded.batches]
        divided = graded is self._divided.mesh(row)
        slack = 0.0 if divided else self._graded.slack(self._group_of[row], self._triangles_of(row))
        return [
            replace(draw, batch=batch, triangles=triangles, first=place, count=1, slack=slack)
            for draw, batch, triangles in own
        ]

    def _level(self, row, index):
        return level_for_sample(self.levels[row], *self._plan.in_round(index))

    def _of_single(self, draws, index):
        """List the draw calls for a sample of the rows that are drawn on their own."""
        copied = self._shared.rows_of(index)
        listed = []
        for row in self._single:
            if row not in copied:
                listed += self._of_row(draws, row, self._level(row, index), index)
        return listed

    def _count(self, listed):
        self.counts.draw_calls += len(listed)
        self.counts.triangles += sum(d.triangles * d.count for d in listed)

    def _draw(self, listed, view, lens_sample, index, optics, lights):
        self._count(listed)
        state.opaque()
        resources = {"highlights": self._highlights, "optics": optics, "lights": lights}
        surface.draw_sample(listed, view, self._table, lens_sample, index, **resources)

    def confine(self, part):
        """Restrict the following samples to a part of the raster, inside that of `aim`."""
        self._part = part
        self._glass.confine(part)

    def confined(self):
        """Return a context in which only the part of `confine` is drawn."""
        if self._part is None:
            return nullcontext()
        return state.scissored(*(self._plan.subpixels * side for side in self._part))

    def draw(self, index, framebuffer, view, targets):
        """Draw the opaque surfaces for a lens sample.

        Parameters
        ----------
        index : int
        framebuffer : GPUFrameBuffer
            The sample's, cleared.
        view : GPUUniformBuf
        targets : Targets
            With those of `specs`.
        """
        plan, shared = self._plan, self._shared
        listed = self._list(self._draws, index) + self._of_single(self._by_level, index)
        # Before anything is bound: light maps have a frame buffer of their own.
        lights = self.lights.of_samples(index, (index,))
        with framebuffer.bind(), self.confined():
            optics = self._optics(index)
            self._draw(listed, view, plan.lens_sample(index), index, optics, lights)

        def draw_parent(sprite, lights):
            drawn = self._of_row(self._by_level, sprite.row, sprite.level, index)
            parent = sprite.parent
            optics = self._optics(parent)
            self._draw(drawn, view, plan.lens_sample(parent), parent, optics, lights)

        def light_parent(sprite):
            return self.lights.of_samples(index, sprite.members)

        before = shared.drawn + shared.copied
        shared.copy(index, framebuffer, targets, draw_parent, light_parent)
        self.counts.draw_calls += shared.drawn + shared.copied - before
        self.counts.sprites_drawn = shared.drawn
        self.counts.sprites_copied = shared.copied

    def draw_through(self, index, framebuffer, view, targets):
        """Draw glass and veils over a lens sample that `draw` has drawn; parameters as there."""
        if self._glass.is_seen:
            self._draw_glass(index, view, targets)
        self._draw_veils(index, framebuffer, view)

    def _draw_glass(self, index, view, targets):
        # Before anything is bound, as in `draw`.
        resources = self._resources(index)
        given = (view, self._table, self._plan.lens_sample(index), index)

        def of_row(draws, row):
            return self._of_row(draws, row, self._level(row, index), index)

        def draw(draws, bindings=()):
            self._count(draws)
            surface.draw_sample(draws, *given, bindings, **resources)

        def draw_behind(framebuffer):
            if self._highlights:
                split = self._glass.split_light()
                listed = self._list(split.draws, index) + self._of_single(split.by_level, index)
                state.behind()
                with framebuffer.bind(), self.confined():
                    draw(listed)
            self._draw_veils(index, framebuffer, view)

        self._glass.draw(targets, self.lights, self.confined, of_row, draw, draw_behind)

    def _resources(self, index):
        lights = self.lights.of_samples(index, (index,))
        return {"highlights": self._highlights, "optics": self._optics(index), "lights": lights}

    def _draw_veils(self, index, framebuffer, view):
        """Filter a lens sample by coloured surfaces, and add the light of transparent ones."""
        listed = self._list(self._veils.draws, index)
        listed = self._veils.in_order(listed + self._of_single(self._veils.by_level, index))
        self._count(listed)
        if listed:
            resources = self._resources(index)
            given = (listed, view, self._table, self._plan.lens_sample(index), index)
            with framebuffer.bind(), self.confined():
                surface.draw_veils(*given, **resources)

    @property
    def has_chance(self):
        """Whether any surface may let light through, or add some to what is behind it."""
        return bool(self._veils.draws or self._glass.draws) or any(
            draw.transparent for draw in self._draws
        )

    @property
    def content(self):
        """The `SceneContent` that it draws."""
        return self._content

    def specs(self):
        """Return the render targets that drawing needs besides the sample's."""
        return (*self._shared.specs(), *self._glass.specs(self._plan))

    def surfaces(self):
        """Return group and slot of all surfaces."""
        return frozenset(
            (draw.group, draw.slot)
            for draw in (*self._draws, *self._veils.draws, *self._glass.draws)
        )

    def see_through(self):
        """Return group and slot of the surfaces that may let light through."""
        return frozenset((draw.group, draw.slot) for draw in self._draws if draw.transparent)

    def full_detail_draws(self, target, wanted=None):
        """Return the draws, at full detail, of the visible instances for another target.

        Parameters
        ----------
        target : passes.surface.surface_target.SurfaceTarget
        wanted : set of (int, int) or None
            See `passes.surface.surface.build_draws`.

        Returns
        -------
        list of Draw
            With rows of the content's own instance table.
        """
        draws = surface.build_draws(self._content, self._buffers, target, wanted)
        return [
            replace(draw, first=first, count=count)
            for draw in draws
            if draw.level == 0
            for first, count in culling.runs(
                draw.first + np.flatnonzero(self._seen[draw.first : draw.first + draw.count]),
                draw.triangles,
            )
        ]

    def detail_table(self):
        """Return the content's instance table, with levels and shares of shared drawings."""
        detail = np.column_stack([self.levels, self._shared.shares(len(self.levels), self._plan)])
        return texture_2d(instance_texels(self._content.instances, detail))

    def geometry_bytes(self):
        """Return how many bytes graded and divided meshes take on the device."""
        return self._graded.bytes + self._divided.bytes

    def texture_bytes(self):
        """Return how many bytes shared drawings take on the device."""
        return self._shared.bytes() + self.lights.bytes + self._glass.bytes

    def release(self):
        """Give light maps and probes back to the device."""
        self.lights.release()
        self._glass.release()
