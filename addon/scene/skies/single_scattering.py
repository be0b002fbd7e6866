"""The sky of an atmosphere whose light is scattered once.

Air and aerosols thin out exponentially, ozone lies in a layer; the sun's light is scattered towards
the eye along each ray. 21 wavelengths from 380 to 780 nm. Lengths are in m.

References
----------
Nishita, Sirai, Tadamura and Nakamae, Display of the Earth taking into account atmospheric
scattering, SIGGRAPH 1993. Bruneton, A qualitative and quantitative evaluation of 8 clear sky
models, 2016: the layer of ozone.
"""

from dataclasses import replace

import numpy as np

from ...sampling.spectrum import color_matching
from .scattering import (
    between_azimuths,
    coarse_azimuths,
    cosines_to_sun,
    distance_after,
    phase_of_air,
    points_on_rays,
    to_sphere,
)

_EARTH_RADIUS = 6360e3
_ATMOSPHERE_RADIUS = 6420e3
# Of the eye.
_HIGHEST = 59999.0
# Along a ray, and from its points to the sun.
_STEPS, _POINTS_TO_SUN = 32, 12
_AZIMUTHS = 32

_WAVELENGTHS = np.arange(380.0, 790.0, 20.0)
# The sun as a black body, outside of the atmosphere, W / (m2 nm).
_SUN = np.array(
    [
        *(1.45756830, 1.56596305, 1.65148449, 1.71496242, 1.75797984, 1.78256408, 1.79095108),
        *(1.78541550, 1.76815555, 1.74122070, 1.70647127, 1.66556087, 1.61993437, 1.57083597),
        *(1.51932335, 1.46628495, 1.41245853, 1.35844962, 1.30474914, 1.25174963, 1.19975999),
    ]
)
# 1 / m at sea level: scattered by air as the fourth power of the wavelength, by aerosols alike.
_AIR = 1.131147e6 / _WAVELENGTHS**4
_AEROSOLS = 2e-5
# What aerosols absorb beside it.
_AEROSOL_LOSS = 1.11
_ASYMMETRY = 0.76
_AIR_HEIGHT, _AEROSOL_HEIGHT = 8000.0, 1200.0
# Absorbed by ozone where it is densest.
_OZONE = 1e-9 * np.array(
    [
        *(3.25126850, 5.85395365, 19.7719116, 73.0956876, 200.845615, 403.839581, 635.513359),
        *(967.070412, 1547.97400, 2090.38647, 2461.28056, 2735.51299, 2151.25863, 1590.51841),
        *(1123.56198, 735.275515, 464.501304, 330.960799, 225.126123, 148.791293, 168.286234),
    ]
)


def _densities(atmosphere, height):
    """Return densities of air, aerosols and ozone, relative; shape (..., 3)."""
    layer = np.where(height < 25e3, height / 15e3 - 2.0 / 3.0, 8.0 / 3.0 - height / 15e3)
    parts = (
        atmosphere.air * np.exp(-height / _AIR_HEIGHT),
        atmosphere.aerosols * np.exp(-height / _AEROSOL_HEIGHT),
        atmosphere.ozone * np.maximum(layer, 0.0),
    )
    return np.stack(parts, axis=-1)


def _spectral_to_xyz():
    """Return CIE XYZ (rows) of the radiances of the wavelengths, shape (3, 21)."""
    return 20.0 * color_matching(_WAVELENGTHS).T


def _passing(depth):
    """Return the share of light that passes, by wavelength, of depths of shape (..., 3)."""
    loss = np.stack([_AIR, np.full_like(_AIR, _AEROSOL_LOSS * _AEROSOLS), _OZONE])
    return np.exp(-depth @ loss)


def _depth_to_sun(atmosphere, radius, cosine):
    """Return optical depths (..., 3) from a distance to the Earth's middle along a cosine."""
    # Gauss' points, closer where the air is densest: at the start.
    points, weights = np.polynomial.legendre.leggauss(_POINTS_TO_SUN)
    end = to_sphere(radius, cosine, _ATMOSPHERE_RADIUS)
    total = np.zeros((*end.shape, 3))
    for point, weight in zip(0.5 * points + 0.5, weights, strict=True):
        r = distance_after(radius, point * point * end, cosine)
        total += _densities(atmosphere, r - _EARTH_RADIUS) * (point * weight * end)[..., None]
    return total


def radiance(atmosphere, altitude, sun_elevation, elevation, azimuth):
    """Return the light of the sky above the horizon, without the sun's disc.

    Parameters
    ----------
    atmosphere : Atmosphere
    altitude : float
        Of the eye, m.
    sun_elevation : float
        Radians.
    elevation : ndarray of shape (H,)
        0 to pi / 2.
    azimuth : ndarray of shape (W,)
        From the sun, radians.

    Returns
    -------
    ndarray of shape (H, W, 3)
        CIE XYZ.
    """
    radius = _EARTH_RADIUS + _clipped(altitude)
    sums = _sums(atmosphere, radius, sun_elevation, elevation, coarse_azimuths(_AZIMUTHS))
    by_air, by_aerosols = (between_azimuths(part, azimuth) for part in sums)
    cosine = cosines_to_sun(sun_elevation, elevation, azimuth)[..., None]
    g2 = _ASYMMETRY**2
    spread = (1.0 + g2 - 2.0 * _ASYMMETRY * cosine) ** 1.5
    phase_of_aerosols = 3.0 * (1.0 - g2) / (8.0 * np.pi * (2.0 + g2)) * (1.0 + cosine**2) / spread
    return phase_of_air(cosine) * by_air + phase_of_aerosols * by_aerosols


def sunlight(atmosphere, altitude, elevation):
    """Return what is left of the sun's light.

    Parameters
    ----------
    atmosphere : Atmosphere
    altitude : float
        Of the eye, m.
    elevation : float
        Of the sun, radians.

    Returns
    -------
    ndarray of shape (3,)
        CIE XYZ.
    """
    # As in Cycles, ozone takes nothing of the disc.
    atmosphere = replace(atmosphere, ozone=0.0)
    cosine = np.array([np.sin(elevation)])
    depth = _depth_to_sun(atmosphere, _EARTH_RADIUS + _clipped(altitude), cosine)
    return ((_SUN * _passing(depth)) @ _spectral_to_xyz().T)[0]


def _clipped(altitude):
    return min(max(altitude, 1.0), _HIGHEST)


def _sums(atmosphere, radius, sun_elevation, elevation, azimuth):
    """Return XYZ scattered towards the eye by air and by aerosols, phases left out."""
    step = to_sphere(radius, np.sin(elevation), _ATMOSPHERE_RADIUS) / _STEPS
    depth = np.zeros((len(elevation), 3))
    to_xyz = (_spectral_to_xyz() * _SUN).T
    sums = np.zeros((2, len(elevation), len(azimuth), 3))
    for i in range(_STEPS):
        distance, sun = points_on_rays(radius, (i + 0.5) * step, sun_elevation, elevation, azimuth)
        here = _densities(atmosphere, distance - _EARTH_RADIUS)
        depth = depth + here * step[:, None]
        far = np.broadcast_to(distance[:, None], sun.shape)
        lit = (sun >= 0.0) | (far**2 * (1.0 - sun**2) > _EARTH_RADIUS**2)
        passed = _passing(depth[:, None] + _depth_to_sun(atmosphere, far, sun))
        passed *= (lit * step[:, None])[..., None]
        air, aerosols = here[:, None, None, 0], here[:, None, None, 1]
        sums[0] += (passed * _AIR * air) @ to_xyz
        sums[1] += (passed * aerosols * _AEROSOLS) @ to_xyz
    return sums
