"""Bounding boxes of the instances of a scene, in world space.

A box is its middle and three edges, from the middle to a face: the range of a linear function over
it, such as depth, is then three products a box, not one for each corner.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

# Signs of the corners: the last coordinate changes fastest.
_SIGNS = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3, indexing="ij")).reshape(3, 8).T


@dataclass(frozen=True, eq=False)
class InstanceBoxes:
    """Boxes of instances.

    Parameters
    ----------
    centers : ndarray of shape (I, 3)
        float64, m.
    edges : ndarray of shape (3, I, 3)
        float64, m; for each axis of object space from the middle to the middle of a face.
    """

    centers: np.ndarray
    edges: np.ndarray

    @cached_property
    def radii(self):
        """Half the longest diagonal, shape (I,), m."""
        a, b, c = self.edges
        diagonals = (a + b + c, a + b - c, a - b + c, a - b - c)
        return np.sqrt(np.max([np.einsum("ij,ij->i", d, d) for d in diagonals], axis=0))

    def corners(self, rows=slice(None)):
        """Return the corners of some boxes, shape (R, 8, 3)."""
        reach = np.einsum("sa,aik->isk", _SIGNS, self.edges[:, rows])
        return self.centers[rows, None] + reach

    def range_along(self, direction):
        """Return middles and half widths of boxes along a vector of shape (3,), shape (I,) each."""
        return self.centers @ direction, np.abs(self.edges @ direction).sum(axis=0)

    def of_rows(self, rows):
        """Return the boxes of some rows."""
        return InstanceBoxes(self.centers[rows], self.edges[:, rows])


def instance_boxes(world, groups, bounds):
    """Return the boxes of instances.

    Parameters
    ----------
    world : ndarray of shape (I, 4, 4)
        Object to world space.
    groups : iterable of InstanceGroup
    bounds : callable
        From a mesh's uid to its bounding box in object space, shape (2, 3).

    Returns
    -------
    InstanceBoxes
        Empty boxes in the origin of instances that belong to no group.
    """
    ends = np.zeros((len(world), 2, 3))
    for group in groups:
        ends[group.first : group.first + group.count] = bounds(group.mesh)
    middle, half = ends.mean(axis=1), np.ptp(ends, axis=1) / 2.0
    turn = world[:, :3, :3].astype(np.float64)
    centers = np.einsum("ijk,ik->ij", turn, middle) + world[:, :3, 3]
    edges = turn.transpose(2, 0, 1) * half.T[:, :, None]
    return InstanceBoxes(centers, np.ascontiguousarray(edges))
