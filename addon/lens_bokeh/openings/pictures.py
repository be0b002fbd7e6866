"""An opening given by a grey picture."""

import hashlib
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ...errors import InputError
from ...sampling.iris import Density
from .masks import iris_mask

# Texels along a side of the mask by which lens samples are spread, as fine as the layers of discs;
# and of one that only tells whether there is light.
_SPREAD, _COARSE = 512, 64


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
    stop : bool
        A real lens' round stop cuts off what lies farther from the middle than the radius; without
        it the corners of the picture are open, too.
    """

    picture: np.ndarray
    rotation: float = 0.0
    stop: bool = False
    _grey: np.ndarray = field(init=False, repr=False)

    # Its coverage is the mean over a square; see `iris_mask`.
    has_means = True

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
        if iris_mask(self, _COARSE).max() <= 0.0:
            raise InputError(
                "iris picture lets light through outside of the opening only, as it is turned;"
                " paint it nearer to the middle"
            )

    def __eq__(self, other):
        """Whether both are the same opening; each picture is looked through once only."""
        return isinstance(other, PictureIris) and self._identity == other._identity

    def __hash__(self):
        """Hash what `__eq__` compares."""
        return hash(self._identity)

    @cached_property
    def _identity(self):
        picture = np.ascontiguousarray(self._grey)
        return picture.shape, self.rotation, self.stop, hashlib.sha256(picture).digest()

    @property
    def area(self):
        """Transmitting area in units of the squared radius."""
        if self.stop:
            return float(iris_mask(self, _SPREAD).sum()) * (2.0 / _SPREAD) ** 2
        return float(self._grey.sum()) * (2.0 / max(self._grey.shape)) ** 2

    def amplitude(self):
        """Return the opening whose coverage is the share of amplitude, the root of intensity."""
        return PictureIris(np.sqrt(self._grey), self.rotation, self.stop)

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
        covered = np.clip(total / (2.0 * half) ** 2, 0.0, 1.0)
        if not self.stop:
            return covered
        clear = (1.0 - np.hypot(points[..., 0], points[..., 1])) / np.maximum(width, 1e-12)
        return covered * np.clip(0.5 + clear, 0.0, 1.0)

    def spread(self, square):
        """Distribute points of the unit square by transmission; see `sampling.iris.Opening`."""
        return self._density.points(square)

    @cached_property
    def _density(self):
        return Density(iris_mask(self, _SPREAD))

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
