"""Grain and dust of an opening: a seeded texture by which a mask is multiplied.

Grain is smooth noise in two octaves, made of random numbers on square lattices that are joined by
cubic interpolation. Dust is a number of soft dark spots. Both live in the coordinates of the
opening (unit radius), so that the same seed gives the same speckles at every size of the sprite;
the mean over the opening is 1, so that a uniform pattern keeps its energy.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from ..openings.masks import texel_centres

# The finer octave has half the cells and half the amplitude, as film grain has little energy in
# its finest details.
_OCTAVES = ((1.0, 0.8), (2.0, 0.6))
# More lattice cells than this across the opening are finer than any sprite.
_MOST_CELLS = 512


@dataclass(frozen=True)
class Grain:
    """Strength and size of grain, and number, size and depth of dust spots.

    Parameters
    ----------
    strength : float
        Standard deviation of the grain relative to the mean, 0 to 1.
    cell : float
        Size of a grain relative to the radius of the opening.
    dust : int
        Number of spots.
    dust_radius : float
        Of the largest spot, relative to the radius of the opening; the smallest has a third.
    dust_depth : float
        Share of light that the middle of a spot takes away, 0 to 1.
    seed : int
    """

    strength: float = 0.0
    cell: float = 0.05
    dust: int = 0
    dust_radius: float = 0.06
    dust_depth: float = 0.5
    seed: int = 0

    def __post_init__(self):
        """Check that all values are in range."""
        for name, low, high in (
            ("strength", 0.0, 1.0),
            ("cell", 2.0 / _MOST_CELLS, 2.0),
            ("dust", 0, 1000),
            ("dust_radius", 1e-3, 1.0),
            ("dust_depth", 0.0, 1.0),
            ("seed", 0, 2**63 - 1),
        ):
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(f"grain: {name} is {value:g}; it must be from {low:g} to {high:g}")


def transmission(grain, points):
    """Transmittance of grain and dust at places of the opening.

    Parameters
    ----------
    grain : Grain
    points : ndarray of shape (..., 2)
        In units of the radius of the opening; the texture reaches to 1.5.

    Returns
    -------
    ndarray of shape (...)
        At least 0; its mean over the unit disc is 1.
    """
    points = np.asarray(points, dtype=float)
    return _raw(grain, points) / _mean_over_disc(grain)


def _raw(grain, points):
    generator = np.random.default_rng(grain.seed)
    factor = np.ones(points.shape[:-1])
    if grain.strength > 0.0:
        noise = np.zeros(points.shape[:-1])
        for fineness, amplitude in _OCTAVES:
            cell = grain.cell / fineness
            lattice = generator.standard_normal((int(3.0 / cell) + 4,) * 2)
            noise += amplitude * _interpolated(lattice, (points + 1.5) / cell)
        # An exponential stays positive where a sum would not, at any strength.
        factor = np.exp(grain.strength * noise)
    if grain.dust > 0:
        passed = _passed_dust(grain, generator, points.reshape(-1, 2))
        factor = factor * passed.reshape(factor.shape)
    return factor


def _passed_dust(grain, generator, points):
    """Light that the spots leave at points, shape (N, 2)."""
    places = generator.random((grain.dust, 3))
    radius = np.sqrt(places[:, 0])
    angle = 2.0 * np.pi * places[:, 1]
    size = grain.dust_radius * (1.0 + 2.0 * places[:, 2]) / 3.0
    # A spot is small: of all points only those of its own height are looked at.
    order = np.argsort(points[:, 1], kind="stable")
    x, y = points[order].T
    passed = np.ones(len(points))
    for r, a, s in zip(radius, angle, size, strict=True):
        middle = (r * np.cos(a), r * np.sin(a))
        rows = slice(*np.searchsorted(y, (middle[1] - s, middle[1] + s)))
        near = np.flatnonzero(np.abs(x[rows] - middle[0]) < s) + rows.start
        distance = np.hypot(x[near] - middle[0], y[near] - middle[1]) / s
        spot = np.clip(1.0 - distance**2, 0.0, None) ** 2
        passed[near] *= 1.0 - grain.dust_depth * spot
    result = np.empty(len(points))
    result[order] = passed
    return result


def _mean_over_disc(grain):
    points = texel_centres(256)
    inside = np.hypot(points[..., 0], points[..., 1]) <= 1.0
    return max(float(_raw(grain, points)[inside].mean()), 1e-12)


def _interpolated(lattice, position):
    """Cubic B-spline through random numbers, scaled so that its variance is 1 on average."""
    last = lattice.shape[0] - 4
    # Beyond the lattice the outermost cell goes on.
    position = np.clip(position, 0.0, last + 0.999)
    cell = np.floor(position).astype(int)
    wx, wy = (_cubic_weights(position[..., axis] - cell[..., axis]) for axis in (0, 1))
    total, square = 0.0, 0.0
    for j in range(4):
        for i in range(4):
            weight = wx[i] * wy[j]
            total = total + weight * lattice[cell[..., 1] + j, cell[..., 0] + i]
            square = square + weight**2
    return total / np.sqrt(square)


def _cubic_weights(t):
    return (
        (1.0 - t) ** 3 / 6.0,
        (3.0 * t**3 - 6.0 * t**2 + 4.0) / 6.0,
        (-3.0 * t**3 + 3.0 * t**2 + 3.0 * t + 1.0) / 6.0,
        t**3 / 6.0,
    )
