"""Where the samples of a round have points of the scene through a real lens, for shared drawings.

What a real lens adds to a thin one varies over an object, and need not be largest at the corners of
its box: points in between are looked at, too, three along each of its axes, which tell a parabola.
"""

from functools import cached_property

import numpy as np


class LensMoves:
    """Movements through the real lens of a frame.

    Parameters
    ----------
    plan : FramePlan
        With a `real_lens`; samples from its `first` on are those of the round.
    """

    def __init__(self, plan):
        self._plan = plan
        self._round = slice(plan.first, None)

    @cached_property
    def _tables(self):
        # Made for the first object that may share drawings.
        plan = self._plan
        places, colors = plan.lens_positions[self._round], plan.lens_colors(self._round)
        moves = plan.real_lens.tables.moves(places, colors)
        return moves.reshape(len(moves), -1, *moves.shape[3:])

    def of_box(self, corners):
        """Return how samples move the points of a box from where a pinhole has them.

        Parameters
        ----------
        corners : ndarray of shape (8, 3)
            In camera space, in front of the camera, as `levels.choosing.world_corners` orders them.

        Returns
        -------
        places : ndarray of shape (27, 2)
            Of the pinhole's, px.
        moves : ndarray of shape (N, 27, 2)
            In px, without the jitter.
        """
        plan, lens = self._plan, self._plan.real_lens
        eye = _between(corners)
        depth = -eye[:, 2]
        positions = plan.lens_positions[self._round]
        if plan.chromatic is None:
            shear = 1.0 - depth / plan.focus_distance
            moved = -positions[:, None] * shear[:, None]
        else:
            moved = plan.chromatic.displaced(eye, positions, self._round)[..., :2] - eye[:, :2]
        moved = moved + lens.tables.added(eye, self._tables)
        scale = np.diag(plan.projection)[:2] * np.array([plan.width, plan.height]) / 2.0
        clip = np.column_stack([eye, np.ones(len(eye))]) @ plan.projection.T
        size = np.array([plan.width, plan.height])
        places = (clip[:, :2] / clip[:, 3:] + 1.0) / 2.0 * size
        return places, moved * scale / depth[:, None]

    def rectangle(self, places, moves):
        """Return the rectangle that a box may cover in the raster of any lens sample.

        Parameters
        ----------
        places, moves : ndarray
            Of `of_box`.

        Returns
        -------
        tuple of 4 int or None
            x, y, width, height; None if it is outside.
        """
        plan = self._plan
        size = np.array([plan.width, plan.height])
        # Points between those that were looked at, rounding, and the jitter to whole pixels.
        margin = np.ptp(moves, axis=1).max(axis=0) + 2.0
        margin += np.abs(plan.jitter).max(axis=0, initial=0.0) * size / 2.0
        low, high = (
            (places + moves.min(axis=0)).min(axis=0),
            (places + moves.max(axis=0)).max(axis=0),
        )
        low = np.clip(np.floor(low - margin), 0, size).astype(int)
        high = np.clip(np.ceil(high + margin), 0, size).astype(int)
        if (high <= low).any():
            return None
        return (*low.tolist(), *(high - low).tolist())


def _between(corners):
    """Return the corners of a box, the middles of its edges and faces, and its own."""
    box = corners.reshape(2, 2, 2, 3)
    for axis in range(3):
        first, last = np.split(box, 2, axis=axis)
        box = np.concatenate([first, 0.5 * (first + last), last], axis=axis)
    return box.reshape(-1, 3)
