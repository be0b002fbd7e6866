"""Mattes in numpy: the twins of `passes.cryptomatte` and of the focus share in `lens_lib.glsl`."""

import numpy as np


def coc_radius_px(depth, focus_distance, scale, orthographic=False):
    """Signed radius of the circle of confusion as the shaders compute it.

    Parameters
    ----------
    depth : ndarray of shape (...)
        Along the axis, in m.
    focus_distance : float
    scale : float
        `FramePlan.coc_scale`.
    orthographic : bool

    Returns
    -------
    ndarray of shape (...)
        In pixels.
    """
    defocus = scale * (depth - focus_distance) / focus_distance
    return defocus if orthographic else defocus / depth


def focus_share(coc_px, sharp_px):
    """Share of a point's light inside the largest circle that counts as sharp.

    Parameters
    ----------
    coc_px : ndarray of shape (...)
    sharp_px : float

    Returns
    -------
    ndarray of shape (...)
        `min(1, sharp / |coc|)^2`.
    """
    return (sharp_px / np.maximum(np.abs(coc_px), sharp_px)) ** 2


class RankTable:
    """Counts of ids with a bounded number of slots a pixel.

    Parameters
    ----------
    shape : tuple of int
    slots : int
    """

    def __init__(self, shape, slots):
        self.ids = np.zeros((*shape, slots), np.float32)
        self.counts = np.zeros((*shape, slots), np.float32)

    def count(self, ids):
        """Count one sample.

        Parameters
        ----------
        ids : ndarray of shape (...)
            float32; 0 is nothing.
        """
        for place in np.ndindex(ids.shape):
            if ids[place] != 0.0:
                self._count_one(place, ids[place])

    def _count_one(self, place, identifier):
        ids, counts = self.ids[place], self.counts[place]
        known = np.flatnonzero((ids == identifier) & (counts > 0))
        free = np.flatnonzero(counts == 0)
        if len(known):
            slot = known[0]
        elif len(free):
            slot = free[0]
        else:
            slot = int(np.argmin(counts))
        ids[slot] = identifier
        counts[slot] += 1.0

    def ranks(self, samples):
        """Return ids and coverage by falling coverage, the earlier slot first among equals.

        Returns
        -------
        ids, coverage : ndarray of shape (..., slots)
        """
        order = np.argsort(-self.counts, axis=-1, kind="stable")
        ids = np.take_along_axis(self.ids, order, axis=-1)
        counts = np.take_along_axis(self.counts, order, axis=-1)
        return np.where(counts > 0, ids, 0.0), counts / samples
