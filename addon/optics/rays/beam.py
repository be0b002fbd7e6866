"""Beams: the rays from one object point to a lens, by two coordinates.

Coordinates (u, v) in mm lie in a plane through the vertex of surface 1, across the beam's axis,
which points from the object to that vertex: u along the first, v along the second of two unit
vectors across it. For an object at infinity all rays are parallel and a cell du dv carries that
area; for a near point they diverge, and a cell carries a solid angle.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import PrescriptionError
from .trace import Rays


@dataclass(frozen=True)
class Beam:
    """The rays of an object point; make it by `from_infinity` or `from_point`.

    Parameters
    ----------
    axis, across, up : ndarray of shape (3,)
        Unit vectors: where the beam goes, and those of u and v.
    distance : float
        Object to the vertex of surface 1, mm; inf for an object at infinity.
    """

    axis: np.ndarray
    across: np.ndarray
    up: np.ndarray
    distance: float

    @classmethod
    def from_infinity(cls, field_deg, azimuth_deg=90.0):
        """Return the beam of an object at infinity.

        Parameters
        ----------
        field_deg : float
            Between its rays and the axis of the lens, degrees, -90 to 90 (both excluded).
        azimuth_deg : float
            Of its rays around the axis of the lens, from +x to +y: 90 for the direction
            (0, sin field, cos field).

        Returns
        -------
        Beam

        Raises
        ------
        PrescriptionError
            If the field angle is not below 90 degrees.
        """
        if not abs(field_deg) < 90.0:
            raise PrescriptionError(f"field angle {field_deg:g} must be below 90 degrees")
        field, azimuth = np.radians(float(field_deg)), np.radians(float(azimuth_deg))
        return cls._along(np.sin(field), np.cos(field), azimuth, np.inf)

    @classmethod
    def from_point(cls, point):
        """Return the beam of a point in front of the lens.

        Parameters
        ----------
        point : sequence of 3 float
            mm from the vertex of surface 1; z is negative.

        Returns
        -------
        Beam

        Raises
        ------
        PrescriptionError
            If the point is not in front of the lens.
        """
        x, y, z = map(float, point)
        if not (z < 0.0 and np.isfinite([x, y, z]).all()):
            raise PrescriptionError(
                f"object point ({x:g}, {y:g}, {z:g}) mm must lie in front of the lens (z < 0)"
            )
        height = np.hypot(x, y)
        distance = np.hypot(height, z)
        azimuth = np.arctan2(-y, -x) if height > 0.0 else np.pi / 2.0
        return cls._along(height / distance, -z / distance, azimuth, distance)

    @classmethod
    def _along(cls, sine, cosine, azimuth, distance):
        c, s = np.cos(azimuth), np.sin(azimuth)
        axis = np.array([sine * c, sine * s, cosine])
        across = np.array([s, -c, 0.0])
        return cls(axis, across, np.array([cosine * c, cosine * s, -sine]), float(distance))

    @property
    def is_parallel(self):
        """Whether the object is at infinity."""
        return np.isinf(self.distance)

    def rays(self, coordinates):
        """Return rays through points of the plane.

        Parameters
        ----------
        coordinates : ndarray of shape (N, 2)
            mm.

        Returns
        -------
        Rays
        """
        places = coordinates[:, :1] * self.across + coordinates[:, 1:] * self.up
        if self.is_parallel:
            return Rays(places, np.broadcast_to(self.axis, places.shape))
        directions = places + self.distance * self.axis
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        return Rays(places, directions)

    def coordinates(self, points):
        """Return where the rays through points cross the plane.

        Parameters
        ----------
        points : ndarray of shape (N, 3)
            mm from the vertex of surface 1.

        Returns
        -------
        ndarray of shape (N, 2)
            mm. A point level with the object or behind it counts as if a little before it.
        """
        flat = np.stack([points @ self.across, points @ self.up], axis=-1)
        if self.is_parallel:
            return flat
        ahead = self.distance + points @ self.axis
        return flat * (self.distance / np.maximum(ahead, 1.0e-6 * self.distance))[:, None]

    def density(self, coordinates):
        """Return the light in each cell of the plane, per mm^2.

        Parameters
        ----------
        coordinates : ndarray of shape (N, 2)
            mm.

        Returns
        -------
        ndarray of shape (N,)
            1 for an object at infinity: area across the beam per area. Else solid angle seen from
            the object per area, sr / mm^2.
        """
        if self.is_parallel:
            return np.ones(len(coordinates))
        square = self.distance**2 + np.sum(coordinates**2, axis=1)
        return self.distance / (square * np.sqrt(square))

    def miss(self, points, directions):
        """Return by how much rays that left the lens backwards fail to be rays of this beam.

        Parameters
        ----------
        points, directions : ndarray of shape (N, 3)
            mm, and unit vectors towards the scene.

        Returns
        -------
        ndarray of shape (N, 2)
            Components along u and v: of the direction (with the sign of forward travel) for an
            object at infinity, else of the distance at which the ray passes it, in units of the
            object's distance.
        """
        if self.is_parallel:
            return np.stack([-directions @ self.across, -directions @ self.up], axis=-1)
        offset = -self.distance * self.axis - points
        offset -= np.sum(offset * directions, axis=1)[:, None] * directions
        return np.stack([offset @ self.across, offset @ self.up], axis=-1) / self.distance
