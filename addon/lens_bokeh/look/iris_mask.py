"""Openings of the iris as masks: curved blades, or any grey picture.

Model: an opening of unit circumradius, as in `addon.sampling.iris`: the first *side* of a polygon
is centred on the direction `rotation`. Each side is an arc through its two corners whose curvature
is `curvature` times that of the unit circle: 0 gives the straight polygon, 1 the round opening.
With half the angle of a side h = pi / blades, the distance q beyond the chord, the place t along
it, and k = curvature, the signed distance inside the arc is

``(k (sin^2 h - q^2 - t^2) - 2 q w) / (1 + sqrt((k q + w)^2 + k^2 t^2))``, w = sqrt(1 - k^2 sin^2 h)

which has no singular case at k = 0. Coordinates: x to the right, y up, in units of the radius of
the opening. Arrays of masks have row 0 at the bottom (y = -1 side), so that index and coordinate
grow together.
"""

import hashlib
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ...errors import InputError


@dataclass(frozen=True)
class BladedIris:
    """An opening made by blades.

    Parameters
    ----------
    blades : int
        0 for a round opening, else 3 to 32.
    curvature : float
        0 for straight sides .. 1 for a circle.
    rotation : float
        Direction of the middle of the first side, in radians, anticlockwise.
    """

    blades: int = 0
    curvature: float = 0.0
    rotation: float = 0.0

    def __post_init__(self):
        """Check that blades can form the opening."""
        if self.blades != 0 and not 3 <= self.blades <= 32:
            raise InputError(f"iris has {self.blades} blades; use 0 (round) or 3 to 32")
        if not 0.0 <= self.curvature <= 1.0:
            raise InputError(f"blade curvature is {self.curvature:g}; it must be from 0 to 1")
        if not np.isfinite(self.rotation):
            raise InputError(f"iris rotation is {self.rotation:g}; it must be a finite angle")

    @property
    def area(self):
        """Area of the opening; pi for a round one."""
        if self.blades == 0:
            return np.pi
        half = np.pi / self.blades
        straight = self.blades * np.sin(half) * np.cos(half)
        # On each side stands a segment, of half angle b, of the circle of radius 1 / curvature.
        # b - sin b cos b loses its digits for small b, its series does not.
        k = self.curvature
        chord = k * np.sin(half)
        if chord < 1e-3:
            return straight + self.blades * k * np.sin(half) ** 3 * (2.0 / 3.0 + chord**2 / 5.0)
        b = np.arcsin(chord)
        return straight + self.blades * (b - np.sin(b) * np.cos(b)) / k**2

    def amplitude(self):
        """Return the opening whose coverage is the share of amplitude: itself, being binary."""
        return self

    def clearance(self, points):
        """Signed distance to the rim, positive inside.

        Parameters
        ----------
        points : ndarray of shape (..., 2)

        Returns
        -------
        ndarray of shape (...)
            Exact near the middle of a side; beyond a corner it is the distance to the side's
            continuation.
        """
        points = np.asarray(points, dtype=float)
        radius = np.hypot(points[..., 0], points[..., 1])
        if self.blades == 0:
            return 1.0 - radius
        half = np.pi / self.blades
        angle = np.arctan2(points[..., 1], points[..., 0]) - self.rotation
        angle = np.mod(angle + half, 2.0 * half) - half
        q = radius * np.cos(angle) - np.cos(half)
        t = radius * np.sin(angle)
        k = self.curvature
        w = np.sqrt(1.0 - (k * np.sin(half)) ** 2)
        upper = k * (np.sin(half) ** 2 - q**2 - t**2) - 2.0 * q * w
        return upper / (1.0 + np.hypot(k * q + w, k * t))

    def coverage(self, points, width):
        """Share of a small square that is open.

        Parameters
        ----------
        points : ndarray of shape (..., 2)
            Centres of the squares.
        width : float or ndarray of shape (...)
            Side of the squares; the rim is taken as straight over one.

        Returns
        -------
        ndarray of shape (...)
            0 to 1.
        """
        return np.clip(0.5 + self.clearance(points) / np.maximum(width, 1e-12), 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class PictureIris:
    """An opening given by a grey picture; two of the same picture and rotation are equal.

    Parameters
    ----------
    picture : ndarray of shape (height, width) or (height, width, channels)
        Linear transmission; the largest value counts as open, negative ones as closed. Channels
        (the first three) are averaged. Row 0 is the bottom. The longer side spans the diameter.
    rotation : float
        In radians, anticlockwise.
    """

    picture: np.ndarray
    rotation: float = 0.0
    _grey: np.ndarray = field(init=False, repr=False)

    def __post_init__(self):
        """Check that the picture lets light through."""
        picture = np.asarray(self.picture, dtype=float)
        if picture.ndim == 3:
            picture = picture[..., :3].mean(axis=-1)
        if picture.ndim != 2 or picture.size == 0:
            raise InputError(f"iris picture has shape {self.picture.shape}; give (height, width)")
        if not np.isfinite(picture).all():
            raise InputError("iris picture has values that are not finite; repair the picture")
        picture = np.maximum(picture, 0.0)
        if picture.max() <= 0.0:
            raise InputError("iris picture is black; paint the opening white")
        if not np.isfinite(self.rotation):
            raise InputError(f"iris rotation is {self.rotation:g}; it must be a finite angle")
        object.__setattr__(self, "_grey", picture / picture.max())

    def __eq__(self, other):
        """Whether both are the same opening; each picture is looked through once only."""
        return isinstance(other, PictureIris) and self._identity == other._identity

    def __hash__(self):
        """Hash what `__eq__` compares."""
        return hash(self._identity)

    @cached_property
    def _identity(self):
        picture = np.ascontiguousarray(self._grey)
        return picture.shape, self.rotation, hashlib.sha256(picture).digest()

    @property
    def area(self):
        """Transmitting area in units of the squared radius."""
        return float(self._grey.sum()) * (2.0 / max(self._grey.shape)) ** 2

    def amplitude(self):
        """Return the opening whose coverage is the share of amplitude, the root of intensity."""
        return PictureIris(np.sqrt(self._grey), self.rotation)

    def coverage(self, points, width):
        """Mean transmission of a small square.

        Parameters
        ----------
        points : ndarray of shape (..., 2)
            Centres of the squares.
        width : float or ndarray of shape (...)
            Side of the squares.

        Returns
        -------
        ndarray of shape (...)
            0 to 1; 0 outside the picture.
        """
        points = np.asarray(points, dtype=float)
        height, columns = self._grey.shape
        cos, sin = np.cos(self.rotation), np.sin(self.rotation)
        pitch = 2.0 / max(height, columns)
        x = (points[..., 0] * cos + points[..., 1] * sin) / pitch + columns / 2.0
        y = (points[..., 1] * cos - points[..., 0] * sin) / pitch + height / 2.0
        # A table of sums makes the mean over any box four look-ups; a box is at least one pixel
        # of the picture, which is the tent filter of a linear look-up.
        half = np.maximum(np.asarray(width, dtype=float) / pitch, 1.0) / 2.0
        left, right = np.clip(x - half, 0, columns), np.clip(x + half, 0, columns)
        low, high = np.clip(y - half, 0, height), np.clip(y + half, 0, height)
        sums = self._sums
        total = (
            _between(sums, high, right)
            - _between(sums, low, right)
            - _between(sums, high, left)
            + _between(sums, low, left)
        )
        return np.clip(total / (2.0 * half) ** 2, 0.0, 1.0)

    @cached_property
    def _sums(self):
        height, columns = self._grey.shape
        sums = np.zeros((height + 1, columns + 1))
        sums[1:, 1:] = self._grey.cumsum(axis=0).cumsum(axis=1)
        return sums


def _between(sums, y, x):
    row = np.minimum(y.astype(int), sums.shape[0] - 2)
    column = np.minimum(x.astype(int), sums.shape[1] - 2)
    v, u = y - row, x - column
    lower = sums[row, column] * (1.0 - u) + sums[row, column + 1] * u
    upper = sums[row + 1, column] * (1.0 - u) + sums[row + 1, column + 1] * u
    return lower * (1.0 - v) + upper * v


def texel_centres(size, extent=1.0):
    """Centres of the texels of a square picture.

    Parameters
    ----------
    size : int
        Texels along a side.
    extent : float
        The picture spans -extent to extent.

    Returns
    -------
    ndarray of shape (size, size, 2)
        x along columns, y along rows, rising.
    """
    axis = (np.arange(size) + 0.5) * (2.0 * extent / size) - extent
    return np.stack(np.meshgrid(axis, axis), axis=-1)


def iris_mask(iris, size, extent=1.0, supersampling=4):
    """Draw an opening, antialiased by area.

    Parameters
    ----------
    iris : BladedIris or PictureIris
    size : int
        Texels along a side.
    extent : float
        The mask spans -extent to extent in units of the radius of the opening.
    supersampling : int
        Each texel is the mean of this number squared of squares, within which the rim of blades
        counts as straight and square to the axes. A picture has its own means and needs none.

    Returns
    -------
    ndarray of shape (size, size)
        Open share of each texel, 0 to 1.
    """
    if isinstance(iris, PictureIris):
        supersampling = 1
    fine = size * supersampling
    covered = iris.coverage(texel_centres(fine, extent), 2.0 * extent / fine)
    return covered.reshape(size, supersampling, size, supersampling).mean(axis=(1, 3))
