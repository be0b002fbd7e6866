"""The ray map: heights and slopes behind a lens of the rays of axial points.

The image of an axial point is made of meridional rays. Behind the lens they are straight lines,
given by a height and a slope. A ray is identified by its height p in the paraxial entrance pupil,
as a share s of the *reach* P(V), beyond which no ray gets through. (The height in the stop would
not be unique: in fast lenses it turns back before the pupil ends.) The object is given by its
*vergence* V, 1 / distance to the entrance pupil; 0 at infinity.

Near the axis height and slope are ``p (c0 + c1 V)``. The map stores these two coefficients apart
and, on a grid over wavelength, V and s, only what the real ray adds to them. The aberrations are
smooth over V and s, so that a small grid gives them to many digits, and they keep their digits in
single precision next to heights that are a thousand times larger.

Further values of each ray on the same grid:

- *energy radius* g: a point radiates evenly in all directions, so the rays up to s carry their
  solid angle ``pi g^2 V^2``; at infinity g is p. With Fresnel losses each ray counts with what
  it brings through. Stored less p.
- *stop fraction*: the height in the stop over the stop's wide-open radius. A stop closed to a share
  of its radius blocks what is above it.
- for each rim that blocks anything: the height there over the rim's radius.

Lengths are in mm, z from the vertex of surface 1. A lens with cylinders is taken in its y meridian.
"""

from dataclasses import dataclass, fields

import numpy as np

# Rays between which the edges of the pupil are bracketed.
_EDGE_RAYS = 513
HEIGHT, SLOPE, ENERGY, STOP = range(4)


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
    pupil_radius : float
        Its radius, wide open.
    reach : ndarray of shape (3,)
        P(V), lowest power first.
    reference : ndarray of shape (2, 2)
        Paraxial coefficients of the reference wavelength: rows height and slope, columns c0, c1.
    paraxial : ndarray of shape (L, 2, 2)
        The same of each wavelength.
    values : ndarray of float32, shape (4 + rims, L, K, M)
        Height and slope less the paraxial ones, energy radius less p, stop fraction, and the
        height over each rim; over s from 0 to 1.
    limits : ndarray of shape (L, K)
        The s beyond which rays miss a surface or are totally reflected.
    """

    wavelengths_nm: np.ndarray
    vergences: np.ndarray
    plane: float
    pupil: float
    pupil_radius: float
    reach: np.ndarray
    reference: np.ndarray
    paraxial: np.ndarray
    values: np.ndarray
    limits: np.ndarray

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

    def rays(self, vergence, stop_fraction=1.0, count=1025):
        """Rays of one axial point that get through, evenly spaced over the pupil.

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
            At `plane`, mm; tangent; rising. If a ring of the pupil is blocked, its two edges are
            neighbours with the same energy radius.
        """
        weights, nodes = lagrange_weights(self.vergences, vergence)
        values = np.tensordot(self.values[:, :, nodes].astype(np.float64), weights, (2, 0))
        limits = np.tensordot(self.limits[:, nodes], weights, (1, 0))
        share, gaps = _open_shares(values, limits, stop_fraction, count)
        height, slope, radius = interpolate_odd(values[: ENERGY + 1], share)
        across = share * np.polynomial.Polynomial(self.reach)(self._inside(vergence))
        linear = self.paraxial @ np.array([1.0, vergence])
        height += across * linear[:, 0, None]
        slope += across * linear[:, 1, None]
        square = np.maximum(radius + across, 0.0) ** 2
        steps = np.maximum(np.diff(square, axis=1, prepend=0.0), 0.0)
        steps[gaps] = 0.0
        return height, slope, np.sqrt(np.cumsum(steps, axis=1))

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

    def _inside(self, vergence):
        return min(max(vergence, 0.0), self.vergences[-1])

    @classmethod
    def blend(cls, maps, weights):
        """Weighted mean of the maps of neighbouring settings of one lens.

        Parameters
        ----------
        maps : sequence of RayMap
            Of the same wavelengths, vergences and rims.
        weights : sequence of float

        Returns
        -------
        RayMap
        """

        def mean(name):
            values = [w * getattr(each, name) for each, w in zip(maps, weights, strict=True)]
            return sum(values[1:], values[0])

        return cls(**{field.name: mean(field.name) for field in fields(cls)})


def lagrange_weights(nodes, at, count=4):
    """Weights of polynomial interpolation between the nearest of some nodes.

    Parameters
    ----------
    nodes : ndarray of shape (K,)
        Rising.
    at : float
        Clamped to the nodes' range.
    count : int
        How many nodes take part, even or all.

    Returns
    -------
    weights : ndarray of shape (count,)
    chosen : slice
    """
    at = float(np.clip(at, nodes[0], nodes[-1]))
    first = int(np.clip(np.searchsorted(nodes, at) - count // 2, 0, len(nodes) - count))
    near = nodes[first : first + count]
    weights = [
        np.prod(np.delete(at - near, i)) / np.prod(np.delete(near[i] - near, i))
        for i in range(count)
    ]
    return np.array(weights), slice(first, first + count)


def interpolate_odd(values, share):
    """Cubic interpolation of odd functions on an even grid over [0, 1].

    Parameters
    ----------
    values : ndarray of shape (C, L, M)
    share : ndarray of shape (L, n)

    Returns
    -------
    ndarray of shape (C, L, n)
    """
    last = values.shape[-1] - 1
    place = share * last
    first = np.clip(place.astype(np.int64) - 1, -1, last - 3)
    t = place - first
    weights = (
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    )
    rows = np.arange(len(share))[:, None]
    total = np.zeros((len(values), *share.shape))
    for shift, weight in enumerate(weights):
        index = first + shift
        total += values[:, rows, np.abs(index)] * np.where(index < 0, -weight, weight)
    return total


def _open_shares(values, limits, stop_fraction, count):
    """Places of rays that get through, and where a blocked ring lies before one of them."""
    colors = values.shape[1]
    grid = np.linspace(0.0, 1.0, _EDGE_RAYS)
    found = interpolate_odd(values[STOP:], np.broadcast_to(grid, (colors, _EDGE_RAYS)))
    found[0] /= stop_fraction
    # Above 1 where anything blocks.
    blocked = np.maximum(found.max(axis=0), grid / np.minimum(limits, 1.0)[:, None])
    share = np.empty((colors, count))
    gaps = np.zeros((colors, count), dtype=bool)
    for i in range(colors):
        edges = _crossings(grid, blocked[i] - 1.0)
        lengths = edges[1::2] - edges[::2]
        parts = np.maximum(2, np.floor(count * lengths / lengths.sum()).astype(int))
        parts[np.argmax(parts)] += count - parts.sum()
        share[i] = np.concatenate(
            [np.linspace(*edges[2 * k : 2 * k + 2], n) for k, n in enumerate(parts)]
        )
        gaps[i, np.cumsum(parts)[:-1]] = True
    return share, gaps


def _crossings(grid, level):
    """Return the ends of the stretches on which a function is not above 0: from, to, from, to."""
    inside = level <= 0.0
    # The axis is always open: a closed stop still has its middle.
    inside[0] = True
    turns = np.flatnonzero(inside[1:] != inside[:-1])
    rise = level[turns + 1] - level[turns]
    t = np.divide(-level[turns], rise, out=np.ones_like(rise), where=rise != 0.0)
    places = grid[turns] + np.clip(t, 0.0, 1.0) * grid[1]
    return np.concatenate([[0.0], places, [1.0] if inside[-1] else []])
