"""Drawing the surfaces of a scene for one lens sample after another.

Decides, from the plan, at which level of detail each instance is drawn for each sample, which
samples share a drawing, and keeps the sprites that are shared.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..device import geometry, state
from ..device.targets import Targets, TargetSpec
from ..device.textures import texture_2d
from ..passes import sprite as sprites
from ..passes import surface
from . import culling
from .levels import choose_levels, coc_radius, extents, level_for_sample, world_corners
from .reuse import find_sprites
from .scene_buffers import instance_texels

# On the device, for sprites that wait for their next lens sample.
_SPRITE_BYTES = 256 << 20
_SPRITE_TEXEL_BYTES = 36


@dataclass
class DrawingCounts:
    """Work done so far.

    Attributes
    ----------
    draw_calls, triangles, sprites_drawn, sprites_copied : int
    triangles_full_detail : int
        What every instance for every sample would have taken.
    """

    draw_calls: int = 0
    triangles: int = 0
    triangles_full_detail: int = 0
    sprites_drawn: int = 0
    sprites_copied: int = 0


class SceneDrawing:
    """Draws a content's surfaces.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
        Updated to it.
    target : passes.surface.SurfaceTarget
    """

    def __init__(self, content, buffers, target):
        self.content = content
        self._buffers = buffers
        self._draws = surface.build_draws(content, buffers, target)
        self._glows = surface.build_glow_draws(content, buffers, target)
        self.full_detail = sum(
            d.triangles * d.count for d in (*self._draws, *self._glows) if d.level == 0
        )
        bounds = {uid: mesh.bounds for uid, mesh in buffers.meshes.items()}
        self._spheres = culling.BoundingSpheres(content, bounds)
        self._corners = world_corners(content, bounds)
        self._triangles = [
            [sum(count for _, count in level.batches.values()) for level in
             buffers.mesh_levels(group.mesh)]
            for group in content.groups
        ]  # fmt: skip
        # Decided by chance a sample, or added to what is behind: such surfaces share nothing.
        self._unshared = {d.group for d in self._draws if d.transparent}
        self._unshared |= {d.group for d in self._glows}
        self._fullscreen = geometry.fullscreen_batch()
        self._kept = {}
        self._pool = {}
        self.counts = DrawingCounts()

    def aim(self, plan):
        """Prepare a frame: levels, sprites, order of the instances.

        Parameters
        ----------
        plan : FramePlan
        """
        self.plan = plan
        self.counts = DrawingCounts()
        self._kept = {}
        visible = self._visible = culling.seen(self._spheres, plan)
        self._seen = extents(self._corners, plan.view)
        self.nearest = float(self._seen.nearest[visible].min(initial=np.inf))
        self._levels = self._choose_levels()
        self._sprites = self._find_sprites(visible) if plan.reuse_grid else {}
        shared = np.zeros(len(visible), bool)
        shared[[row for row in self._sprites]] = True
        self._order_rows(visible, shared)

    def _choose_levels(self):
        plan = self.plan
        deepest = np.zeros(len(self._corners), np.int64)
        triangles = np.zeros(len(self._corners))
        for group, counts in zip(self.content.groups, self._triangles, strict=True):
            rows = slice(group.first, group.first + group.count)
            deepest[rows] = len(counts) - 1
            triangles[rows] = counts[0]
        if plan.level_bias is None or not deepest.any():
            return np.zeros(len(self._corners))
        return np.minimum(choose_levels(self._seen, triangles, plan, plan.level_bias), deepest)

    def _find_sprites(self, visible):
        plan = self.plan
        if plan.subpixels != 1:
            return {}
        seen = self._seen
        near, far = coc_radius(seen.nearest, plan), coc_radius(seen.farthest, plan)
        largest = np.where(np.abs(near) > np.abs(far), near, far)
        found = {}
        budget = _SPRITE_BYTES
        samples = range(plan.samples)
        # No cell can be shared by two samples if there are many more cells than samples.
        limit = np.sqrt(plan.samples) + 1.0
        for number, group in enumerate(self.content.groups):
            if number in self._unshared:
                continue
            for row in range(group.first, group.first + group.count):
                if not visible[row] or seen.nearest[row] <= 0.0 or abs(largest[row]) > limit:
                    continue
                rectangle = self._rectangle(row)
                if rectangle is None:
                    continue
                row_level = self._levels[row : row + 1]
                levels = np.array(
                    [level_for_sample(row_level, i, plan.samples)[0] for i in samples]
                )
                for shared in find_sprites(
                    row, float(largest[row]), levels, self._triangles[number], rectangle, plan
                ):
                    size = shared.pixels * _SPRITE_TEXEL_BYTES
                    if size <= budget:
                        budget -= size
                        for member in shared.members:
                            found.setdefault(row, {})[member] = shared
        return found

    def _rectangle(self, row):
        """Return what an instance may cover in the raster of any sample, or None if nothing."""
        plan = self.plan
        eye = self._corners[row] @ plan.view[:3, :3].T + plan.view[:3, 3]
        clip = np.column_stack([eye, np.ones(8)]) @ plan.projection.T
        if (clip[:, 3] <= 0.0).any():
            return None
        size = np.array([plan.width, plan.height])
        places = (clip[:, :2] / clip[:, 3:] + 1.0) / 2.0 * size
        blur = np.abs(coc_radius(-eye[:, 2], plan))[:, None] * plan.lens_extent
        blur = blur / max(plan.lens_extent[1], 1e-30)
        margin = np.abs(plan.jitter).max(axis=0, initial=0.0) * size / 2.0 + 2.0
        low = np.floor((places - blur).min(axis=0) - margin)
        high = np.ceil((places + blur).max(axis=0) + margin)
        low, high = np.clip(low, 0, size), np.clip(high, 0, size)
        if (high <= low).any():
            return None
        return (*low.astype(int).tolist(), *(high - low).astype(int).tolist())

    def _order_rows(self, visible, shared):
        """Put rows in an order in which those of one level are neighbours, where levels differ."""
        count = len(visible)
        lower = np.floor(self._levels)
        change = self._levels - lower
        order = np.arange(count)
        self._rows = {}
        for number, group in enumerate(self.content.groups):
            rows = np.arange(group.first, group.first + group.count)
            drawn = visible[rows] & ~shared[rows]
            kept = rows[drawn]
            places = drawn.nonzero()[0]
            if np.ptp(self._levels[kept]) > 0.0 if len(kept) else False:
                kept = kept[np.lexsort((change[kept], lower[kept]))]
                order[rows] = np.concatenate([kept, rows[~drawn]])
                places = np.arange(len(kept))
            self._rows[number] = (group.first + places, lower[kept], change[kept])
        self._table = self._buffers.instances
        self._place = np.arange(count)
        if not np.array_equal(order, self._place):
            instances = self.content.instances
            ordered = replace(
                instances,
                world=instances.world[order],
                cryptomatte_id=instances.cryptomatte_id[order],
            )
            self._table = texture_2d(instance_texels(ordered))
            self._place[order] = np.arange(count)

    def _runs(self, draw, index):
        """Return the runs of rows of the ordered table that a draw covers for a sample."""
        places, lower, change = self._rows[draw.group]
        if len(places) == 0:
            return []
        coarser = index >= np.round((1.0 - change) * self.plan.samples)
        at_level = places[(lower + coarser).astype(np.int64) == draw.level]
        # Between rows of one level only what cannot be seen may be drawn in passing.
        gap_cost = draw.triangles if len(at_level) == len(places) else np.inf
        return culling.runs(at_level, gap_cost)

    def _list(self, draws, index):
        listed = [
            draw if (first, count) == (draw.first, draw.count)
            else replace(draw, first=first, count=count)
            for draw in draws
            for first, count in self._runs(draw, index)
        ]  # fmt: skip
        return listed

    def draw(self, index, framebuffer, view, targets):
        """Draw the opaque surfaces for a lens sample.

        Parameters
        ----------
        index : int
        framebuffer : GPUFrameBuffer
            The sample's, cleared.
        view : GPUUniformBuf
        targets : Targets
            With those of `scratch_specs` where anything is shared.
        """
        listed = self._list(self._draws, index)
        alone = [row for row, shared in self._sprites.items() if index not in shared]
        for row in alone:
            listed += self._draws_of_row(row, index)
        self._count(listed)
        with framebuffer.bind():
            state.opaque()
            surface.draw_sample(listed, view, self._table, self.plan.lens_sample(index), index)
        for row, shared in self._sprites.items():
            if index in shared:
                self._copy(shared[index], index, framebuffer, view, targets)

    def draw_glows(self, index, framebuffer, view):
        """Add the light of surfaces that glow to what a lens sample shows behind them."""
        listed = self._list(self._glows, index)
        self._count(listed)
        with framebuffer.bind():
            surface.draw_glows(listed, view, self._table, self.plan.lens_sample(index))

    def draw_coarsest(self, framebuffer, view):
        """Draw everything at its coarsest level, from the lens' centre, for its depth alone."""
        coarsest = []
        for draw in self._draws:
            count = len(self._rows[draw.group][1])
            if draw.level == len(self._triangles[draw.group]) - 1 and count:
                coarsest.append(replace(draw, first=draw.first, count=count))
        for row in self._sprites:
            group = self._group_of(row)
            level = len(self._triangles[group]) - 1
            coarsest += self._at_row(row, level)
        self._count(coarsest)
        with framebuffer.bind():
            state.opaque()
            surface.draw_sample(coarsest, view, self._table, (0.0, 0.0, 0.0, 0.0), 0)

    def _count(self, listed):
        self.counts.draw_calls += len(listed)
        self.counts.triangles += sum(d.triangles * d.count for d in listed)

    def _group_of(self, row):
        return next(
            number
            for number, group in enumerate(self.content.groups)
            if group.first <= row < group.first + group.count
        )

    def _draws_of_row(self, row, index):
        level = level_for_sample(self._levels[row : row + 1], index, self.plan.samples)[0]
        return self._at_row(row, int(level))

    def _at_row(self, row, level):
        group, place = self._group_of(row), int(self._place[row])
        return [
            replace(draw, first=place, count=1)
            for draw in self._draws
            if draw.group == group and draw.level == level
        ]

    def _copy(self, shared, index, framebuffer, view, targets):
        kept = self._kept.get(id(shared))
        if kept is None:
            kept = self._kept[id(shared)] = self._make(shared, view, targets)
        x, y, width, height = shared.rectangle
        across, up = shared.members[index]
        with framebuffer.bind(), state.confined(x + across, y + up, width, height):
            sprites.copy(
                self._fullscreen,
                kept["color"],
                kept["depth"],
                kept["mattes"] if "mattes" in kept else None,
                (-x - across, -y - up),
            )
        self.counts.sprites_copied += 1
        self.counts.draw_calls += 1
        if index == max(shared.members):
            self._pool.setdefault((width, height), []).append(self._kept.pop(id(shared)))

    def _make(self, shared, view, targets):
        """Draw a sprite for its parent, and keep its rectangle."""
        listed = self._at_row(shared.row, shared.level)
        self._count(listed)
        mattes = "scratch_mattes" in targets
        names = ("scratch", "scratch_mattes") if mattes else ("scratch",)
        framebuffer = targets.framebuffer(*names, depth="scratch_depth")
        x, y, width, height = shared.rectangle
        with framebuffer.bind(), state.scissored(x, y, width, height):
            framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
            state.opaque()
            lens_sample = self.plan.lens_sample(shared.parent)
            surface.draw_sample(listed, view, self._table, lens_sample, shared.parent)
        spare = self._pool.get((width, height))
        kept = spare.pop() if spare else Targets(width, height, _sprite_specs(mattes))
        kept.forget_framebuffers()
        names = ("color", "mattes", "depth") if mattes else ("color", "depth")
        with kept.framebuffer(*names).bind():
            sprites.store(
                self._fullscreen,
                targets["scratch"],
                targets["scratch_depth"],
                targets["scratch_mattes"] if mattes else None,
                (x, y),
            )
        self.counts.sprites_drawn += 1
        self.counts.draw_calls += 1
        return kept

    def scratch_specs(self, mattes):
        """Return the targets that drawing needs beside the sample's."""
        if not self._sprites:
            return ()
        names = [("scratch", "RGBA32F"), ("scratch_depth", "DEPTH_COMPONENT32F")]
        names += [("scratch_mattes", "RGBA32F")] * mattes
        return tuple(TargetSpec(name, kind) for name, kind in names)

    def full_detail_draws(self, target):
        """Return the draws, at full detail, of what can be seen, for another target.

        Parameters
        ----------
        target : passes.surface.SurfaceTarget

        Returns
        -------
        list of Draw
            With rows of the content's own instance table.
        """
        draws = surface.build_draws(self.content, self._buffers, target)
        return [
            replace(draw, first=first, count=count)
            for draw in draws
            if draw.level == 0
            for first, count in culling.runs(
                draw.first + np.flatnonzero(self._visible[draw.first : draw.first + draw.count]),
                draw.triangles,
            )
        ]


def _sprite_specs(mattes):
    specs = [TargetSpec("color", "RGBA32F"), TargetSpec("depth", "R32F")]
    return [*specs, *[TargetSpec("mattes", "RGBA32F")] * mattes]
