"""Lenses and rays that the tests of the optics share."""

import math

import numpy as np

from addon.optics.glass import AIR, ConstantGlass
from addon.optics.prescription import Configuration, Surface
from addon.optics.rays.trace import Rays

CROWN = ConstantGlass(1.5168)
FLINT = ConstantGlass(1.7)


def surface(radius=math.inf, thickness=0.0, glass=AIR, semi_diameter=10.0, **more):
    return Surface(radius, thickness, semi_diameter, glass, **more)


def lens(*surfaces, focal_length=50.0, f_number=5.0, half_field_deg=10.0):
    return Configuration(tuple(surfaces), focal_length, f_number, half_field_deg)


def biconvex(radius=50.0, thickness=4.0, glass=CROWN):
    """A symmetric lens with its stop at the front vertex."""
    return lens(
        surface(radius, thickness, glass, is_stop=True), surface(-radius, 48.0, semi_diameter=11.0)
    )


def triplet():
    """A made-up objective with air gaps, a cemented face and the stop inside."""
    return lens(
        surface(30.0, 4.0, CROWN),
        surface(200.0, 3.0, AIR),
        surface(math.inf, 3.0, AIR, semi_diameter=7.0, is_stop=True),
        surface(-60.0, 2.0, FLINT),
        surface(40.0, 5.0, CROWN),
        surface(-35.0, 40.0, AIR),
    )


def symmetric():
    """Two equal menisci around the stop: at magnification -1 all odd errors cancel."""
    return lens(
        surface(18.0, 4.0, CROWN),
        surface(24.0, 5.0, AIR),
        surface(math.inf, 5.0, AIR, semi_diameter=3.0, is_stop=True),
        surface(-24.0, 4.0, CROWN),
        surface(-18.0, 40.0, AIR),
    )


def rays(points, directions):
    """Rays with directions made unit vectors; one point or direction may serve all."""
    points, directions = np.broadcast_arrays(
        np.atleast_2d(np.asarray(points, dtype=float)),
        np.atleast_2d(np.asarray(directions, dtype=float)),
    )
    return Rays(points, directions / np.linalg.norm(directions, axis=1)[:, None])


def parallel(heights):
    """Rays along the axis at heights y."""
    heights = np.atleast_1d(np.asarray(heights, dtype=float))
    return rays(np.stack([0.0 * heights, heights, 0.0 * heights], axis=-1), (0.0, 0.0, 1.0))


def random_rays(count=200, seed=3, spread=8.0, slope=0.15):
    """Rays towards +z near the axis, the same for the same seed."""
    random = np.random.default_rng(seed)
    points = random.uniform(-spread, spread, (count, 3)) * (1.0, 1.0, 0.0)
    directions = random.uniform(-slope, slope, (count, 3))
    directions[:, 2] = 1.0
    return rays(points, directions)
