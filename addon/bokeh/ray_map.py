"""Where the rays of axial points go behind a lens: the ray map.

The image of an axial point is made of rays that lie in planes through the axis. Behind the lens
they are straight lines, told by a height and a slope; which ray it is, is told by its *stop
fraction* sigma: the height at which it meets the stop over the stop's wide-open radius. The
object is told by its *vergence* V, 1 / distance to the paraxial entrance pupil; 0 at infinity.

Near the axis height and slope are ``sigma (c0 + c1 V)``. The map stores these two coefficients
apart and, on a grid over wavelength, V and sigma, only what the real ray adds to them. The
aberrations are smooth over V and sigma, so that a small grid gives them to many digits, and
they keep their digits in single precision next to heights that are a thousand times larger.

Energy: a point radiates evenly in all directions, so the rays up to sigma carry their solid angle.
It is stored as an *effective pupil radius* g, with ``pi g^2 V^2`` the solid angle; at infinity g is
the height of the ray itself. With Fresnel losses each ray counts with what it brings through.

Rims other than the stop are told by the sigma at which each begins to block.

Lengths are in mm, z from the vertex of surface 1. A lens with cylinders is taken in its y meridian.
"""

from dataclasses import dataclass, fields

import numpy as np


@dataclass(frozen=True)
class RayMap:
    """Rays of axial points behind a lens.

    Parameters
    ----------
    wavelengths_nm : ndarray of shape (L,)
    vergences : ndarray of shape (K,)
        Rising from 0, 1/mm.
    plane : float
        Where heights are told: the z of the infinity focus of the reference wavelength.
    pupil : float
        The z of the paraxial entrance pupil of the reference wavelength.
    reference : ndarray of shape (2, 2)
        Paraxial coefficients of the reference wavelength: rows height and slope, columns c0, c1.
    paraxial : ndarray of shape (L, 2, 2)
        The same of each wavelength.
    pupil_radius : float
        Paraxial, wide open.
    residuals : ndarray of float32, shape (3, L, K, M)
        What is to be added to the paraxial height and slope, and to ``sigma pupil_radius``, over
        sigma from 0 to 1.
    limits : ndarray of float32, shape (L, K, S + 1)
        Sigma at which each rim blocks, and beyond which rays miss a surface or are totally
        reflected; the stop itself stands with 1.
    """

    wavelengths_nm: np.ndarray
    vergences: np.ndarray
    plane: float
    pupil: float
    reference: np.ndarray
    paraxial: np.ndarray
    pupil_radius: float
    residuals: np.ndarray
    limits: np.ndarray

    @property
    def fractions(self):
        """Sigma of the grid, shape (M,)."""
        return np.linspace(0.0, 1.0, self.residuals.shape[-1])

    def vergence(self, object_z):
        """Vergence of an axial point.

        Parameters
        ----------
        object_z : array_like of shape (...)
            mm from surface 1, before the entrance pupil; -inf is allowed.

        Returns
        -------
        ndarray of shape (...)
        """
        return 1.0 / (self.pupil - np.asarray(object_z, dtype=np.float64))

    def rays(self, vergence, stop_fraction=1.0, count=1024):
        """Rays of one axial point that get through, evenly spaced over the stop.

        Parameters
        ----------
        vergence : float
            1/mm. Beyond the last of the map the aberrations are those of the last.
        stop_fraction : float
            How far the stop is open, 0 to 1.
        count : int
            How many, from the axis to the rim.

        Returns
        -------
        height, slope, energy_radius : ndarray of shape (L, count)
            At `plane`, mm; tangent; effective pupil radius, mm, rising.
        """
        weights, nodes = lagrange_weights(self.vergences, vergence)
        residuals = np.tensordot(self.residuals[:, :, nodes].astype(float), weights, (2, 0))
        ends = self.open_fraction(vergence, stop_fraction)
        sigma = ends[:, None] * np.linspace(0.0, 1.0, count)
        height, slope, radius = _interpolate_odd(residuals, sigma)
        linear = self.paraxial @ np.array([1.0, vergence])
        height += sigma * linear[:, 0, None]
        slope += sigma * linear[:, 1, None]
        radius += sigma * self.pupil_radius
        return height, slope, np.maximum.accumulate(np.maximum(radius, 0.0), axis=1)

    def open_fraction(self, vergence, stop_fraction=1.0):
        """Largest sigma that gets through, by wavelength.

        Parameters
        ----------
        vergence : float
        stop_fraction : float

        Returns
        -------
        ndarray of shape (L,)
        """
        weights, nodes = lagrange_weights(self.vergences, vergence)
        limits = np.tensordot(self.limits[:, nodes].astype(float), weights, (1, 0))
        return np.clip(limits.min(axis=1), 1.0e-6, min(1.0, stop_fraction))

    def focus_plane(self, vergence):
        """Return the z of the paraxial image of an axial point, reference wavelength.

        Parameters
        ----------
        vergence : float

        Returns
        -------
        float
            mm from surface 1; inf for an image at infinity.
        """
        height, slope = self.reference @ np.array([1.0, vergence])
        return self.plane - height / slope if slope else np.inf

    @classmethod
    def blend(cls, maps, weights):
        """Weighted mean of the maps of neighbouring settings of one lens.

        Parameters
        ----------
        maps : sequence of RayMap
            Of the same wavelengths and vergences.
        weights : sequence of float

        Returns
        -------
        RayMap
        """

        def mean(name):
            values = [
                weight * getattr(each, name) for each, weight in zip(maps, weights, strict=True)
            ]
            return sum(values[1:], values[0])

        names = [field.name for field in fields(cls)]
        return cls(**{name: mean(name) for name in names})


def lagrange_weights(nodes, at):
    """Weights of cubic interpolation between the four nearest of some nodes.

    Parameters
    ----------
    nodes : ndarray of shape (K,)
        Rising, at least four.
    at : float
        Clamped to the nodes' range.

    Returns
    -------
    weights : ndarray of shape (4,)
    chosen : slice
    """
    at = float(np.clip(at, nodes[0], nodes[-1]))
    first = int(np.clip(np.searchsorted(nodes, at) - 2, 0, len(nodes) - 4))
    near = nodes[first : first + 4]
    weights = [
        np.prod(np.delete(at - near, i)) / np.prod(np.delete(near[i] - near, i)) for i in range(4)
    ]
    return np.array(weights), slice(first, first + 4)


def _interpolate_odd(values, sigma):
    """Cubic interpolation of odd functions on an even grid over [0, 1].

    Parameters
    ----------
    values : ndarray of shape (C, L, M)
    sigma : ndarray of shape (L, n)

    Returns
    -------
    ndarray of shape (C, L, n)
    """
    last = values.shape[-1] - 1
    place = sigma * last
    first = np.clip(place.astype(np.int64) - 1, -1, last - 3)
    t = place - first
    weights = (
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    )
    rows = np.arange(len(sigma))[:, None]
    total = np.zeros((len(values), *sigma.shape))
    for shift, weight in enumerate(weights):
        index = first + shift
        weight = np.where(index < 0, -weight, weight)
        total += values[:, rows, np.abs(index)] * weight
    return total
