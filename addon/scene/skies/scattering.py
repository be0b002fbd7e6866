"""What both skies of scattered light share: amounts, ways through the air, and phases.

Neither knows a unit of length: radii and ways are in that of the caller.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Atmosphere:
    """Amounts relative to those of a clear day.

    Parameters
    ----------
    air, aerosols, ozone : float
    """

    air: float = 1.0
    aerosols: float = 1.0
    ozone: float = 1.0


def to_sphere(radius, cosine, sphere):
    """Return the way from inside a sphere to it.

    Parameters
    ----------
    radius, cosine : ndarray of shape (...)
        Distance from the sphere's middle, and the cosine of the way's angle to the zenith.
    sphere : float
        Its radius.

    Returns
    -------
    ndarray of shape (...)
    """
    return -radius * cosine + np.sqrt(np.maximum(sphere**2 - radius**2 * (1.0 - cosine**2), 0.0))


def distance_after(radius, way, cosine):
    """Return the distance from the Earth's middle after a way along a cosine, shape (...)."""
    return np.sqrt(radius**2 + way**2 + 2.0 * radius * way * cosine)


def points_on_rays(radius, way, sun_elevation, elevation, azimuth):
    """Return where rays of the eye are after a way, and how high the sun stands there.

    Parameters
    ----------
    radius : float
        Of the eye, from the Earth's middle.
    way : ndarray of shape (H,)
    sun_elevation : float
        At the eye, radians.
    elevation : ndarray of shape (H,)
        Of the rays, radians.
    azimuth : ndarray of shape (W,)
        From the sun, radians.

    Returns
    -------
    distance : ndarray of shape (H,)
        From the Earth's middle.
    sun : ndarray of shape (H, W)
        Cosine of the angle between the sun and the zenith of the point.
    """
    z, x = radius + way * np.sin(elevation), way * np.cos(elevation)
    distance = np.sqrt(z * z + x * x)
    towards = z[:, None] * np.sin(sun_elevation) + x[:, None] * np.cos(azimuth) * np.cos(
        sun_elevation
    )
    return distance, towards / distance[:, None]


def coarse_azimuths(count):
    """Return azimuths from the sun for `between_azimuths`, radians, shape (count,)."""
    return np.linspace(0.0, np.pi, count)


def between_azimuths(light, azimuth):
    """Read light that is known at coarse azimuths between them.

    Parameters
    ----------
    light : ndarray of shape (H, count, C)
        At `coarse_azimuths`; the two sides of the sun are alike.
    azimuth : ndarray of shape (W,)
        From the sun, radians.

    Returns
    -------
    ndarray of shape (H, W, C)
        Of the same type.
    """
    last = light.shape[1] - 1
    place = np.abs((azimuth + np.pi) % (2.0 * np.pi) - np.pi) / np.pi * last
    low = np.minimum(place.astype(int), last - 1)
    share = (place - low)[:, None].astype(light.dtype)
    return light[:, low] * (1.0 - share) + light[:, low + 1] * share


def cosines_to_sun(sun_elevation, elevation, azimuth):
    """Return the cosines of the angles between rays and the sun, shape (H, W)."""
    up, across = np.sin(elevation)[:, None], np.cos(elevation)[:, None] * np.cos(sun_elevation)
    return across * np.cos(azimuth) + up * np.sin(sun_elevation)


def phase_of_air(cosine):
    """Return Rayleigh's phase function, 1 / sr, shape (...)."""
    return 3.0 / (16.0 * np.pi) * (1.0 + cosine * cosine)
