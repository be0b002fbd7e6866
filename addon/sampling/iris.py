"""The iris: from the unit square to the opening, area-uniformly.

Model: an opening of unit circumradius. A round one is the unit disk; one with n >= 3 blades is the
regular polygon whose first *side* is centred on the direction `rotation`, which is how Cycles
turns it; any other opening says itself where the points of the square come to lie. The anamorphic
ratio then divides the horizontal axis. All maps preserve areas, weighed by what the opening lets
through, so that a uniform sequence stays uniform: no sample is rejected, and weights are equal.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np


class Opening(Protocol):
    """A shape that blades and rotation do not tell; two that are equal have the same points."""

    @property
    def area(self):
        """Transmitting area in units of the squared radius of the opening."""

    def spread(self, square):
        """Distribute points of the unit square over the opening, by what it lets through.

        Parameters
        ----------
        square : ndarray of shape (..., 2)
            In [0, 1).

        Returns
        -------
        ndarray of shape (..., 2)
            In units of the opening's radius, before the anamorphic ratio.
        """


@dataclass(frozen=True)
class Iris:
    """Shape of the opening.

    Parameters
    ----------
    blades : int
        Number of sides; below 3 the opening is round, as in Cycles.
    rotation : float
        In radians, anticlockwise in the camera's xy plane.
    ratio : float
        Anamorphic ratio, > 0: the opening's width is divided by it.
    opening : Opening or None
        Curved blades or a picture, turned already; None: the regular polygon of the blades.
    """

    blades: int = 0
    rotation: float = 0.0
    ratio: float = 1.0
    opening: Opening | None = None

    @property
    def shared_area(self):
        """Area that lens samples share, before the anamorphic ratio, over the squared radius.

        That of straight blades is taken as that of the circle round them.
        """
        return np.pi if self.opening is None else self.opening.area


def concentric_disk(square):
    """Map the unit square to the unit disk, keeping areas and neighbourhoods.

    Parameters
    ----------
    square : ndarray of shape (..., 2)
        In [0, 1).

    Returns
    -------
    ndarray of shape (..., 2)
        Inside the unit disk; (0.5, 0.5) becomes the centre.

    References
    ----------
    Shirley and Chiu, A low distortion map between disk and square, JGT 2(3), 1997.
    """
    ab = 2.0 * np.asarray(square, dtype=np.float64) - 1.0
    a, b = ab[..., 0], ab[..., 1]
    wide = np.abs(a) > np.abs(b)
    radius = np.where(wide, a, b)
    divisor = np.where(radius == 0.0, 1.0, radius)
    angle = np.where(wide, np.pi / 4 * (b / divisor), np.pi / 2 - np.pi / 4 * (a / divisor))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def polygon(square, blades, rotation):
    """Map the unit square to a regular polygon of unit circumradius, keeping areas.

    The square is first laid on the disk; the disk's sectors then become the polygon's triangles:
    within a sector the angle runs along the side and the squared radius stays the area.

    Parameters
    ----------
    square : ndarray of shape (..., 2)
        In [0, 1).
    blades : int
        Number of sides, at least 3.
    rotation : float
        Direction of the middle of the first side, in radians.

    Returns
    -------
    ndarray of shape (..., 2)
    """
    disk = concentric_disk(square)
    radius = np.hypot(disk[..., 0], disk[..., 1])
    turn = np.mod(np.arctan2(disk[..., 1], disk[..., 0]) / (2 * np.pi), 1.0) * blades
    side = np.floor(turn)
    along = turn - side
    half = np.pi / blades
    start = rotation + (2 * side - 1) * half
    end = start + 2 * half
    x = radius * ((1 - along) * np.cos(start) + along * np.cos(end))
    y = radius * ((1 - along) * np.sin(start) + along * np.sin(end))
    return np.stack([x, y], axis=-1)


def star(square, sides, rotation, reach, shares):
    """Map the unit square to a star-shaped opening of equal sides, keeping areas.

    As `polygon` does, but within a sector the angle follows from the share of its area.

    Parameters
    ----------
    square : ndarray of shape (..., 2)
        In [0, 1).
    sides : int
    rotation : float
        Direction of the middle of the first side, in radians.
    reach : callable
        From angles to the middle of a side, shape (...), to the distance of the rim.
    shares : ndarray of shape (K,)
        Rising from 0 to 1: the share of a sector's area up to the angles that divide it evenly.

    Returns
    -------
    ndarray of shape (..., 2)
    """
    disk = concentric_disk(square)
    turn = np.mod(np.arctan2(disk[..., 1], disk[..., 0]) / (2 * np.pi), 1.0) * sides
    side = np.floor(turn)
    half = np.pi / sides
    angle = np.interp(turn - side, shares, np.linspace(-half, half, len(shares)))
    radius = np.hypot(disk[..., 0], disk[..., 1]) * reach(angle)
    direction = rotation + 2 * half * side + angle
    return np.stack([radius * np.cos(direction), radius * np.sin(direction)], axis=-1)


class Density:
    """Inverse of a density's cumulative distribution: columns first, then places in a column.

    Parameters
    ----------
    mask : ndarray of shape (M, M)
        Means over the texels of a square from -1 to 1, x along columns, y along rows, rising; at
        least 0, and somewhere more. Within a texel the density is even.
    """

    def __init__(self, mask):
        columns = np.asarray(mask, dtype=np.float64).T
        self._size = len(columns)
        # Of all texels, column by column: one rising row in which every place is found.
        self._sums = np.concatenate([[0.0], columns.ravel().cumsum()])
        self._ends = self._sums[:: self._size]

    def points(self, square):
        """Distribute points of the unit square by the density.

        Parameters
        ----------
        square : ndarray of shape (..., 2)
            In [0, 1).

        Returns
        -------
        ndarray of shape (..., 2)
            In [-1, 1].
        """
        square = np.asarray(square, dtype=np.float64)
        column, x = _inverse(self._ends, square[..., 0] * self._ends[-1])
        first, last = self._ends[column], self._ends[column + 1]
        # Rounding must not lead into the next column.
        wanted = np.minimum(first + square[..., 1] * (last - first), np.nextafter(last, first))
        texel, y = _inverse(self._sums, wanted)
        place = np.stack([column + x, texel - column * self._size + y], axis=-1)
        return place * (2.0 / self._size) - 1.0


def _inverse(sums, wanted):
    """Return in which step of a rising sum values lie, never one of height 0, and how far in it."""
    wanted = np.minimum(wanted, np.nextafter(sums[-1], 0.0))
    step = np.searchsorted(sums, wanted, side="right") - 1
    low, high = sums[step], sums[step + 1]
    return step, (wanted - low) / (high - low)


def iris_points(square, iris):
    """Distribute points of the unit square over an iris.

    Parameters
    ----------
    square : ndarray of shape (..., 2)
        In [0, 1).
    iris : Iris

    Returns
    -------
    ndarray of shape (..., 2)
        Positions in units of the aperture radius, x to the right and y up as the camera sees
        them; uniform over the opening.
    """
    if iris.opening is not None:
        points = iris.opening.spread(square)
    elif iris.blades >= 3:
        points = polygon(square, iris.blades, iris.rotation)
    else:
        points = concentric_disk(square)
    return points * np.array([1.0 / iris.ratio, 1.0])
