"""An opening made by blades, straight or curved.

Model: an opening of unit circumradius, as in `addon.sampling.iris`: the first *side* of a polygon
is centred on the direction `rotation`. Each side is an arc through its two corners whose curvature
is `curvature` times that of the unit circle: 0 gives the straight polygon, 1 the round opening.
With half the angle of a side h = pi / blades, the distance q beyond the chord, the place t along
it, and k = curvature, the signed distance inside the arc is

``(k (sin^2 h - q^2 - t^2) - 2 q w) / (1 + sqrt((k q + w)^2 + k^2 t^2))``, w = sqrt(1 - k^2 sin^2 h)

which has no singular case at k = 0.

The blades of a lens lie behind a round stop. Drawn back, they leave the stop alone: the lens is
wide open, and its opening is round. As it is stopped down they come in from all sides: the opening
is what stop and blades both leave, until the corners of the blades come in, too, and it is theirs
alone. Light tells how far they have come: at f-number N the opening has (N wide open / N)^2 of the
stop's area. Its unit is the circle round it, whose radius follows from the f-number.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import InputError
from ...sampling.iris import concentric_disk, polygon, star

# Angles in a sector of blades by which samples are spread, and in half of one by which its area is
# found again and again.
_ANGLES, _COARSE_ANGLES = 2049, 257


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
    closing : float or None
        F-number over that of the lens wide open, at least 1, of blades behind a round stop: 1 is
        round. None: there is no such stop, and all f-numbers have the same shape.
    """

    blades: int = 0
    curvature: float = 0.0
    rotation: float = 0.0
    closing: float | None = None

    # Its coverage takes the rim as straight over a square; see `iris_mask`.
    has_means = False

    def __post_init__(self):
        """Check that blades can form the opening."""
        if self.blades != 0 and not 3 <= self.blades <= 32:
            raise InputError(f"iris has {self.blades} blades; use 0 (round) or 3 to 32")
        if not 0.0 <= self.curvature <= 1.0:
            raise InputError(f"blade curvature is {self.curvature:g}; it must be from 0 to 1")
        if not np.isfinite(self.rotation):
            raise InputError(f"iris rotation is {self.rotation:g}; it must be a finite angle")
        if self.closing is not None and not 1.0 <= self.closing < np.inf:
            raise InputError(
                f"iris is closed to {self.closing:g} times the widest f-number; it must be at least"
                " 1 and finite"
            )

    @property
    def is_round(self):
        """Whether no blade is seen."""
        return self.blades == 0 or self.curvature == 1.0 or self.blade_radius >= self._widest_blades

    @property
    def is_polygon(self):
        """Whether straight blades are all that is seen."""
        return not self.is_round and self.curvature == 0.0 and self.blade_radius == 1.0

    @cached_property
    def blade_radius(self):
        """Radius of the circle round the blades over that of the opening, at least 1."""
        if self.blades == 0 or self.closing is None:
            return 1.0
        share = self.closing**-2.0
        if np.pi * share <= self._blade_area:
            return 1.0
        # The area grows with the radius: from that of the blades alone to that of the stop.
        low, high = 1.0, self._widest_blades
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if self._cut_area(middle) > np.pi * share else (middle, high)
        return high

    @property
    def _widest_blades(self):
        """Radius of the circle round blades that just leave the whole stop."""
        return 1.0 / float(self._blade_reach(0.0))

    def _blade_reach(self, angle):
        """Return how far blades of radius 1 are in a direction from the middle of a side."""
        half, k = np.pi / self.blades, self.curvature
        w = np.sqrt(1.0 - (k * np.sin(half)) ** 2)
        # The middle of the side's circle, in radii of that circle.
        middle = k * np.cos(half) - w
        upper = 2.0 * w * np.cos(half) - k * np.cos(2.0 * half)
        rise = np.sqrt(1.0 - (middle * np.sin(angle)) ** 2)
        return upper / (rise - middle * np.cos(angle))

    def _reach(self, angle):
        return np.minimum(1.0, self.blade_radius * self._blade_reach(angle))

    def _cut_area(self, radius):
        """Return the area of a round stop behind blades of a radius."""
        angles = np.linspace(0.0, np.pi / self.blades, _COARSE_ANGLES)
        squares = np.minimum(1.0, radius * self._blade_reach(angles)) ** 2
        return self.blades * np.trapezoid(squares, angles)

    @property
    def area(self):
        """Area of the opening; pi for a round one."""
        if self.is_round:
            return np.pi
        return self._blade_area if self.blade_radius == 1.0 else self._cut_area(self.blade_radius)

    @property
    def _blade_area(self):
        """Area of blades of radius 1."""
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
        if self.is_round:
            return 1.0 - radius
        if self.blade_radius == 1.0:
            return self._blade_clearance(points, radius)
        scale = self.blade_radius
        blades = self._blade_clearance(points / scale, radius / scale) * scale
        return np.minimum(1.0 - radius, blades)

    def _blade_clearance(self, points, radius):
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

    def spread(self, square):
        """Distribute points of the unit square over the opening; see `sampling.iris.Opening`."""
        if self.is_round:
            return concentric_disk(square)
        if self.is_polygon:
            return polygon(square, self.blades, self.rotation)
        return star(square, self.blades, self.rotation, self._reach, self._shares)

    @cached_property
    def _shares(self):
        half = np.pi / self.blades
        squares = self._reach(np.linspace(-half, half, _ANGLES)) ** 2
        sums = np.concatenate([[0.0], (0.5 * (squares[1:] + squares[:-1])).cumsum()])
        return sums / sums[-1]
