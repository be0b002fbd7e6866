"""The sprites of a frame: drawn for the first lens sample that needs one, kept until the last."""

import numpy as np

from ...device import geometry, state
from ...device.targets import Targets, TargetSpec
from ...levels.choosing import coc_ends, level_for_sample
from ...passes import sprite
from .lens_moves import LensMoves
from .raster_boxes import raster_rectangles
from .reuse import find_sprites, sharing_pays

# Most bytes on the device of sprites that wait for their next lens sample.
_BYTES = 256 << 20
# Largest side of what shares drawings through a real lens, over the picture's longer one.
_LARGEST = 1.0 / 3.0
# Places of corners in samples that are looked at at once; through a real lens each takes so many
# times the memory.
_AT_ONCE, _LENS_TAKES = 1 << 20, 32
# A rectangle is never smaller, px.
_LEAST_PIXELS = 1
# Bytes of a sprite's pixel: colour, mattes, depth.
_TEXEL_BYTES = 36


class SharedDrawings:
    """The sprites of a frame and the lens samples that share them.

    Parameters
    ----------
    mattes : bool
        Sprites also hold mattes.

    Attributes
    ----------
    rows : list of int
        Rows of the instance table that share drawings.
    drawn, copied : int
        Numbers of sprites since the frame began.
    fullscreen : GPUBatch
    """

    def __init__(self, mattes):
        self._mattes = mattes
        self.fullscreen = geometry.fullscreen_batch()
        self._pool = {}
        self.forget()

    def forget(self):
        """Begin a frame in which no drawing is shared."""
        self._members = {}
        self._kept = {}
        self.rows = []
        self.drawn = self.copied = 0

    def find(self, candidates, boxes, seen, levels, triangles, plan):
        """Find the sprites of a frame.

        Parameters
        ----------
        candidates : ndarray of shape (C,)
            Rows that may share drawings.
        boxes : InstanceBoxes
        seen : Extents
        levels : ndarray of shape (I,)
        triangles : callable
            From rows to their numbers of triangles by level, shape (R, L).
        plan : FramePlan
        """
        self.forget()
        near, far = coc_ends(seen.nearest, seen.farthest, plan, seen.inverse_focus)
        largest = np.where(np.abs(near) > np.abs(far), near, far)
        # With many more cells than samples, hardly any two samples share one.
        _, count = plan.in_round(plan.samples)
        limit = np.sqrt(count) + 1.0
        # A real lens' blur is looked at below.
        blurred = np.abs(largest[candidates]) - plan.blur_doubt > limit
        rows = candidates[(seen.nearest[candidates] > 0.0) & ~blurred]
        counts = triangles(rows)
        # Most rows of a large scene are too small to pay, wherever they are.
        pays = sharing_pays(counts.max(axis=1, initial=0), _LEAST_PIXELS)
        rows, counts = rows[pays], counts[pays]
        lens = LensMoves(plan) if plan.real_lens else None
        of_row = _LENS_TAKES * LensMoves.POINTS if lens else 8
        at_once = max(1, _AT_ONCE // (count * of_row))
        budget = _BYTES
        for first in range(0, len(rows), at_once):
            part = slice(first, first + at_once)
            for found in self._find(rows[part], boxes, largest, levels, counts[part], plan, lens):
                size = found.pixels * _TEXEL_BYTES
                if size > budget:
                    continue
                budget -= size
                for sample in found.members:
                    self._members.setdefault(sample, {})[found.row] = found
        self.rows = sorted({row for found in self._members.values() for row in found})

    def _find(self, rows, boxes, largest, levels, triangles, plan, lens):
        """Return the `Sprite`s of some rows."""
        _, count = plan.in_round(plan.samples)
        corners = boxes.corners(rows)
        rectangles, kept = raster_rectangles(corners, plan)
        coc, moved = largest[rows], None
        eye = corners @ plan.view[:3, :3].T + plan.view[:3, 3]
        if lens:
            small = rectangles[:, 2:].max(axis=1) <= _LARGEST * max(plan.width, plan.height)
            chosen = np.flatnonzero(kept & small)
            if not chosen.size:
                return []
            rows, triangles, eye = rows[chosen], triangles[chosen], eye[chosen]
            places, moved = lens.of_boxes(eye)
            rectangles, kept = lens.rectangles(places, moved)
            coc = np.abs(moved).max(axis=(1, 2, 3), initial=0.0)
            kept &= coc <= np.sqrt(count) + 1.0
        pixels = rectangles[:, 2] * rectangles[:, 3]
        kept &= sharing_pays(triangles.max(axis=1, initial=0), pixels)
        rows, coc, triangles, eye = rows[kept], coc[kept], triangles[kept], eye[kept]
        chosen = level_for_sample(levels[rows][:, None], np.arange(count), count)
        moved = None if moved is None else moved[kept]
        return find_sprites(rows, coc, chosen, triangles, rectangles[kept], plan, eye, moved)

    def rows_of(self, sample):
        """Return the rows that are not drawn for a lens sample but copied."""
        return self._members.get(sample, {}).keys()

    def shares(self, count, plan):
        """Return for each of `count` rows the share of lens samples that copy a sprite of it."""
        copied = np.zeros(count)
        for found in self._members.values():
            copied[list(found)] += 1.0
        return copied / (plan.samples - plan.first)

    def drawings_of(self, row, samples):
        """Return how often a row is drawn for `samples` lens samples, each sprite counted once."""
        sprites = [found[row] for found in self._members.values() if row in found]
        return samples - len(sprites) + len({id(sprite) for sprite in sprites})

    def specs(self):
        """Return the render targets that it needs besides the sample's."""
        if not self.rows:
            return ()
        names = [("scratch", "RGBA32F"), ("scratch_depth", "DEPTH_COMPONENT32F")]
        names += [("scratch_mattes", "RGBA32F")] * self._mattes
        return tuple(TargetSpec(name, kind) for name, kind in names)

    def copy(self, sample, framebuffer, targets, draw_parent, light):
        """Copy the sprites of a lens sample into its frame buffer, drawing those that are new.

        Parameters
        ----------
        sample : int
        framebuffer : GPUFrameBuffer
        targets : Targets
        draw_parent : callable
            Draws a `Sprite` for its parent, lit by what follows, into the bound frame buffer.
        light : callable
            Returns what the samples of a drawing are lit by; called before anything is bound.
        """
        members = self._members.get(sample, {}).values()
        if not members:
            return
        copies = []
        for found in members:
            kept = self._kept.get(id(found))
            if kept is None:
                lights = light(found.members)
                kept = self._kept[id(found)] = self._make(found, targets, draw_parent, lights)
            x, y, width, height = found.rectangle
            across, up = found.members[sample]
            copies.append((kept, (x + across, y + up, width, height)))
        with framebuffer.bind():
            sprite.copy(self.fullscreen, copies, self._mattes)
        self.copied += len(copies)
        for found in members:
            if sample == found.last:
                kept = self._kept.pop(id(found))
                self._pool.setdefault(found.rectangle[2:], []).append(kept)

    def _make(self, found, targets, draw_parent, lights):
        x, y, width, height = found.rectangle
        names = ("scratch", "scratch_mattes") if self._mattes else ("scratch",)
        framebuffer = targets.framebuffer(*names, depth="scratch_depth")
        with framebuffer.bind(), state.scissored(x, y, width, height):
            framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
            if self._mattes:
                targets.clear("scratch_mattes", (0.0, 0.0, 0.0, 0.0))
            draw_parent(found, lights)
        spare = self._pool.get((width, height))
        kept = spare.pop() if spare else Targets(width, height, _kept_specs(self._mattes))
        kept.forget_framebuffers()
        names = ("color", "mattes", "depth") if self._mattes else ("color", "depth")
        with kept.framebuffer(*names).bind():
            sprite.store(
                self.fullscreen,
                targets["scratch"],
                targets["scratch_depth"],
                targets["scratch_mattes"] if self._mattes else None,
                (x, y),
            )
        self.drawn += 1
        return kept

    def bytes(self):
        """Return how many bytes the kept sprites take on the device."""
        spare = (targets for pool in self._pool.values() for targets in pool)
        return sum(targets.bytes for targets in (*self._kept.values(), *spare))


def _kept_specs(mattes):
    specs = [TargetSpec("color", "RGBA32F"), TargetSpec("depth", "R32F")]
    return [*specs, *[TargetSpec("mattes", "RGBA32F")] * mattes]
