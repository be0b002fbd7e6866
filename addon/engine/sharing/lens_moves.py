"""Where the samples of a round have points of the scene through a real lens, for shared drawings.

What a real lens adds to a thin one varies over an object, and need not be largest at the corners of
its box: points in between are looked at, too, three along each of its axes, which tell a parabola.
"""

from functools import cached_property

import numpy as np

from .raster_boxes import whole_rectangles


class LensMoves:
    """Movements through the real lens of a frame.

    Parameters
    ----------
    plan : FramePlan
        With a `real_lens`; samples from its `first` on are those of the round.
    """

    # Of a box.
    POINTS = 27

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

    def of_boxes(self, corners):
        """Return how samples move the points of boxes from where a pinhole has them.

        Parameters
        ----------
        corners : ndarray of shape (R, 8, 3)
            In camera space, in front of the camera, as `InstanceBoxes.corners` orders them.

        Returns
        -------
        places : ndarray of shape (R, 27, 2)
            Of the pinhole's, px.
        moves : ndarray of shape (R, N, 27, 2)
            In px, without the jitter.
        """
        plan, lens = self._plan, self._plan.real_lens
        eye = _between(corners).reshape(-1, 3)
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
        moves = (moved * scale / depth[:, None]).reshape(len(positions), -1, self.POINTS, 2)
        return places.reshape(-1, self.POINTS, 2), moves.swapaxes(0, 1)

    def rectangles(self, places, moves):
        """Return the rectangles that boxes may cover in the raster of any lens sample.

        Parameters
        ----------
        places, moves : ndarray
            Of `of_boxes`.

        Returns
        -------
        rectangles : ndarray of shape (R, 4)
            int: x, y, width, height.
        inside : ndarray of shape (R,)
            bool; whether it is in the raster.
        """
        plan = self._plan
        size = np.array([plan.width, plan.height])
        # Points between those that were looked at, rounding, and the jitter to whole pixels.
        margin = np.ptp(moves, axis=2).max(axis=1) + 2.0
        margin += np.abs(plan.jitter).max(axis=0, initial=0.0) * size / 2.0
        low = (places + moves.min(axis=1)).min(axis=1) - margin
        high = (places + moves.max(axis=1)).max(axis=1) + margin
        return whole_rectangles(low, high, size)


def _between(corners):
    """Return the corners of boxes, the middles of their edges and faces, and their own."""
    boxes = corners.reshape(-1, 2, 2, 2, 3)
    for axis in (1, 2, 3):
        first, last = np.split(boxes, 2, axis=axis)
        boxes = np.concatenate([first, 0.5 * (first + last), last], axis=axis)
    return boxes.reshape(len(corners), -1, 3)
