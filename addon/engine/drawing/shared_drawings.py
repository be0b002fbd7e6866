"""The sprites of a frame: drawn for the first lens sample that needs one, kept until the last."""

import numpy as np

from ...device import geometry, state
from ...device.targets import Targets, TargetSpec
from ...levels.choosing import coc_ends, level_for_sample
from ...passes import sprite
from .lens_moves import LensMoves
from .reuse import find_sprites

# Most bytes on the device of sprites that wait for their next lens sample.
_BYTES = 256 << 20
# Largest side of what shares drawings through a real lens, over the picture's longer one.
_LARGEST = 1.0 / 3.0
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
    """

    def __init__(self, mattes):
        self._mattes = mattes
        self._fullscreen = geometry.fullscreen_batch()
        self._pool = {}
        self.forget()

    def forget(self):
        """Begin a frame in which no drawing is shared."""
        self._members = {}
        self._kept = {}
        self.rows = []
        self.drawn = self.copied = 0

    def find(self, candidates, corners, seen, levels, triangles, plan):
        """Find the sprites of a frame.

        Parameters
        ----------
        candidates : iterable of int
            Rows that may share drawings.
        corners : ndarray of shape (I, 8, 3)
            Of the instances' bounding boxes, in world space.
        seen : Extents
        levels : ndarray of shape (I,)
        triangles : callable
            From a row to its numbers of triangles by level.
        plan : FramePlan
        """
        self.forget()
        near, far = coc_ends(seen.nearest, seen.farthest, plan, seen.inverse_focus)
        largest = np.where(np.abs(near) > np.abs(far), near, far)
        # With many more cells than samples, hardly any two samples share one.
        _, count = plan.in_round(plan.samples)
        limit = np.sqrt(count) + 1.0
        lens = LensMoves(plan) if plan.real_lens else None
        budget = _BYTES
        for row in candidates:
            # A real lens' blur is looked at below.
            if seen.nearest[row] <= 0.0 or abs(largest[row]) - plan.blur_doubt > limit:
                continue
            rectangle, coc, moved = raster_rectangle(corners[row], plan), float(largest[row]), None
            if rectangle is None:
                continue
            eye = corners[row] @ plan.view[:3, :3].T + plan.view[:3, 3]
            if lens:
                if max(rectangle[2:]) > _LARGEST * max(plan.width, plan.height):
                    continue
                places, moved = lens.of_box(eye)
                rectangle, coc = lens.rectangle(places, moved), float(np.abs(moved).max())
                if rectangle is None or coc > limit:
                    continue
            chosen = level_for_sample(np.full(count, levels[row]), np.arange(count), count)
            given = (row, coc, chosen, triangles(row), rectangle, plan, eye, moved)
            for found in find_sprites(*given):
                size = found.pixels * _TEXEL_BYTES
                if size > budget:
                    continue
                budget -= size
                for sample in found.members:
                    self._members.setdefault(sample, {})[row] = found
        self.rows = sorted({row for found in self._members.values() for row in found})

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

    def copy(self, sample, framebuffer, targets, draw_parent, light_parent):
        """Copy the sprites of a lens sample into its frame buffer, drawing those that are new.

        Parameters
        ----------
        sample : int
        framebuffer : GPUFrameBuffer
        targets : Targets
        draw_parent : callable
            Draws a `Sprite` for its parent, lit by what follows, into the bound frame buffer.
        light_parent : callable
            Returns what a `Sprite` is lit by; called before anything is bound.
        """
        for found in self._members.get(sample, {}).values():
            kept = self._kept.get(id(found))
            if kept is None:
                kept = self._kept[id(found)] = self._make(
                    found, targets, draw_parent, light_parent(found)
                )
            x, y, width, height = found.rectangle
            across, up = found.members[sample]
            with framebuffer.bind(), state.confined(x + across, y + up, width, height):
                sprite.copy(
                    self._fullscreen,
                    kept["color"],
                    kept["depth"],
                    kept["mattes"] if self._mattes else None,
                    (-x - across, -y - up),
                )
            self.copied += 1
            if sample == max(found.members):
                self._pool.setdefault((width, height), []).append(self._kept.pop(id(found)))

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
                self._fullscreen,
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


def raster_rectangle(corners, plan):
    """Return the rectangle that a box may cover in the raster of any lens sample.

    Parameters
    ----------
    corners : ndarray of shape (8, 3)
        In world space.
    plan : FramePlan

    Returns
    -------
    tuple of 4 int or None
        x, y, width, height; None if it is outside or reaches behind the camera.
    """
    eye = corners @ plan.view[:3, :3].T + plan.view[:3, 3]
    clip = np.column_stack([eye, np.ones(8)]) @ plan.projection.T
    if (clip[:, 3] <= 0.0).any():
        return None
    size = np.array([plan.width, plan.height])
    places = (clip[:, :2] / clip[:, 3:] + 1.0) / 2.0 * size
    narrowing = plan.lens_extent / max(plan.lens_extent[1], 1e-30)
    focus = None
    if plan.chromatic is not None:
        ranges = plan.chromatic.ranges(eye[None])
        focus = np.repeat(ranges.inverse_focus, 8, axis=1)
        grown = np.repeat(eye[None], 2, axis=0)
        grown[..., :2] *= ranges.scale[:, :, None]
        clip = np.concatenate([grown, np.ones((2, 8, 1))], axis=-1) @ plan.projection.T
        places = (clip[..., :2] / clip[..., 3:] + 1.0) / 2.0 * size
    blur = np.abs(coc_ends(-eye[:, 2], -eye[:, 2], plan, focus)).max(axis=0)
    blur = blur[:, None] * narrowing
    # Margin for rounding by the rasteriser, and of the jitter to whole pixels.
    margin = np.abs(plan.jitter).max(axis=0, initial=0.0) * size / 2.0 + 2.0
    low = np.clip(np.floor((places - blur).reshape(-1, 2).min(axis=0) - margin), 0, size)
    high = np.clip(np.ceil((places + blur).reshape(-1, 2).max(axis=0) + margin), 0, size)
    if (high <= low).any():
        return None
    return (*low.astype(int).tolist(), *(high - low).astype(int).tolist())
