"""The iris: from the unit square to the opening, area-uniformly.

Model: an opening of unit circumradius. A round one is the unit disk; one with n >= 3 blades is the
regular polygon whose first *side* is centred on the direction `rotation`, which is how Cycles
turns it. The anamorphic ratio then divides the horizontal axis. Both maps preserve areas, so that a
uniform sequence stays uniform: no sample is rejected, and weights are equal.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Iris:
    """Shape of the opening, as Blender's camera describes it.

    Parameters
    ----------
    blades : int
        Number of sides; below 3 the opening is round, as in Cycles.
    rotation : float
        In radians, anticlockwise in the camera's xy plane.
    ratio : float
        Anamorphic ratio, > 0: the opening's width is divided by it.
    """

    blades: int = 0
    rotation: float = 0.0
    ratio: float = 1.0


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
    if iris.blades >= 3:
        points = polygon(square, iris.blades, iris.rotation)
    else:
        points = concentric_disk(square)
    return points * np.array([1.0 / iris.ratio, 1.0])
