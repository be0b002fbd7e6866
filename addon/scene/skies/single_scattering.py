"""The sky of an atmosphere whose light is scattered once.

Air and aerosols thin out exponentially, ozone lies in a layer; the sun's light is scattered towards
the eye along each ray. 21 wavelengths from 380 to 780 nm. Lengths are in m.

References
----------
Nishita, Sirai, Tadamura and Nakamae, Display of the Earth taking into account atmospheric
scattering, SIGGRAPH 1993. Bruneton, A qualitative and quantitative evaluation of 8 clear sky
models, 2016: the layer of ozone.
"""

from dataclasses import dataclass

import numpy as np

from ...sampling.spectrum import color_matching

EARTH_RADIUS = 6360e3
ATMOSPHERE_RADIUS = 6420e3
# Along a ray, and from its points to the sun.
_STEPS, _POINTS_TO_SUN = 32, 12
_AZIMUTHS = 32

WAVELENGTHS = np.arange(380.0, 790.0, 20.0)
# The sun as a black body, outside of the atmosphere, W / (m2 nm).
_SUN = np.array(
    [
        *(1.45756830, 1.56596305, 1.65148449, 1.71496242, 1.75797984, 1.78256408, 1.79095108),
        *(1.78541550, 1.76815555, 1.74122070, 1.70647127, 1.66556087, 1.61993437, 1.57083597),
        *(1.51932335, 1.46628495, 1.41245853, 1.35844962, 1.30474914, 1.25174963, 1.19975999),
    ]
)
# 1 / m at sea level: scattered by air as the fourth power of the wavelength, by aerosols alike.
_AIR = 1.131147e6 / WAVELENGTHS**4
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

    def densities(self, height):
        """Return densities of air, aerosols and ozone, relative; shape (..., 3)."""
        layer = np.where(height < 25e3, height / 15e3 - 2.0 / 3.0, 8.0 / 3.0 - height / 15e3)
        parts = (
            self.air * np.exp(-height / _AIR_HEIGHT),
            self.aerosols * np.exp(-height / _AEROSOL_HEIGHT),
            self.ozone * np.maximum(layer, 0.0),
        )
        return np.stack(parts, axis=-1)


def spectral_to_xyz():
    """Return CIE XYZ (rows) of the radiances of the wavelengths, shape (3, 21)."""
    return 20.0 * color_matching(WAVELENGTHS).T


def _passing(depth):
    """Return the share of light that passes, by wavelength, of depths of shape (..., 3)."""
    loss = np.stack([_AIR, np.full_like(_AIR, _AEROSOL_LOSS * _AEROSOLS), _OZONE])
    return np.exp(-depth @ loss)


def _end(radius, cosine):
    return -radius * cosine + np.sqrt(
        np.maximum(ATMOSPHERE_RADIUS**2 - radius**2 * (1.0 - cosine**2), 0.0)
    )


def depth_to_sun(atmosphere, radius, cosine):
    """Return optical depths (..., 3) from a distance to the Earth's middle along a cosine."""
    # Gauss' points, closer where the air is densest: at the start.
    points, weights = np.polynomial.legendre.leggauss(_POINTS_TO_SUN)
    end = _end(radius, cosine)
    total = np.zeros((*end.shape, 3))
    for point, weight in zip(0.5 * points + 0.5, weights, strict=True):
        way = point * point * end
        r = np.sqrt(radius**2 + way**2 + 2.0 * radius * way * cosine)
        total += atmosphere.densities(r - EARTH_RADIUS) * (point * weight * end)[..., None]
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
    coarse = np.linspace(0.0, np.pi, _AZIMUTHS)
    sums = _sums(atmosphere, altitude, sun_elevation, elevation, coarse)
    place = np.abs((azimuth + np.pi) % (2.0 * np.pi) - np.pi) / np.pi * (_AZIMUTHS - 1)
    low = np.minimum(place.astype(int), _AZIMUTHS - 2)
    share = (place - low)[:, None]
    by_air, by_aerosols = (s[:, low] * (1.0 - share) + s[:, low + 1] * share for s in sums)
    up, sun_up = np.sin(elevation)[:, None], np.sin(sun_elevation)
    across = np.cos(elevation)[:, None] * np.cos(sun_elevation)
    cosine = (across * np.cos(azimuth) + up * sun_up)[..., None]
    air_phase = 3.0 / (16.0 * np.pi) * (1.0 + cosine * cosine)
    g2 = _ASYMMETRY**2
    spread = (1.0 + g2 - 2.0 * _ASYMMETRY * cosine) ** 1.5
    aerosol_phase = 3.0 * (1.0 - g2) / (8.0 * np.pi * (2.0 + g2)) * (1.0 + cosine**2) / spread
    return air_phase * by_air + aerosol_phase * by_aerosols


def sunlight(atmosphere, altitude, cosine):
    """Return CIE XYZ of what is left of the sun's light.

    Parameters
    ----------
    atmosphere : Atmosphere
    altitude : float
        Of the eye, m.
    cosine : ndarray of shape (N,)
        Of the angle between the sun and the zenith.

    Returns
    -------
    ndarray of shape (N, 3)
    """
    depth = depth_to_sun(atmosphere, EARTH_RADIUS + altitude, cosine)
    return (_SUN * _passing(depth)) @ spectral_to_xyz().T


def _sums(atmosphere, altitude, sun_elevation, elevation, azimuth):
    """Return XYZ scattered towards the eye by air and by aerosols, phases left out."""
    radius = EARTH_RADIUS + altitude
    cosine = np.sin(elevation)
    step = _end(radius, cosine) / _STEPS
    depth = np.zeros((len(elevation), 3))
    to_xyz = (spectral_to_xyz() * _SUN).T
    sums = np.zeros((2, len(elevation), len(azimuth), 3))
    for i in range(_STEPS):
        t = (i + 0.5) * step
        z, x = radius + t * cosine, t * np.cos(elevation)
        distance = np.sqrt(z * z + x * x)
        here = atmosphere.densities(distance - EARTH_RADIUS)
        depth = depth + here * step[:, None]
        sun = (
            z[:, None] * np.sin(sun_elevation)
            + x[:, None] * np.cos(azimuth) * np.cos(sun_elevation)
        ) / distance[:, None]
        far = np.broadcast_to(distance[:, None], sun.shape)
        lit = (sun >= 0.0) | (far**2 * (1.0 - sun**2) > EARTH_RADIUS**2)
        passed = _passing(depth[:, None] + depth_to_sun(atmosphere, far, sun))
        passed *= (lit * step[:, None])[..., None]
        air, aerosols = here[:, None, None, 0], here[:, None, None, 1]
        sums[0] += (passed * _AIR * air) @ to_xyz
        sums[1] += (passed * aerosols * _AEROSOLS) @ to_xyz
    return sums
