"""The sky of an atmosphere whose light is scattered more than once.

Air, ozone and aerosols around a round Earth, lit by the sun: scattering of the first order is
integrated along each ray, what comes of higher ones is a fit. Four wavelengths (630, 560, 490 and
430 nm) stand for the spectrum. Lengths are in km.

References
----------
Garcia Linan, Physically based sky model, 2023 (github.com/fgarlin/skytracer): the model and its
fits. Guimera, Gutierrez and Jarabo, A physically-based spatio-temporal sky model, 2018: aerosols.
Hillaire, A scalable and production ready sky and atmosphere rendering technique, EGSR 2020:
integration over a step.
"""

from functools import cache

import numpy as np

from .scattering import (
    between_azimuths,
    coarse_azimuths,
    cosines_to_sun,
    distance_after,
    phase_of_air,
    points_on_rays,
    to_sphere,
)

_EARTH_RADIUS = 6371.0
_THICKNESS = 100.0
# Of the eye, m.
_HIGHEST = 99999.0
# Of the table of transmittances, and of the integral along a ray.
_STEPS = 64
_TABLE_COLUMNS, _TABLE_ROWS = 256, 64
# Azimuths from the sun for which a ray is integrated; phases are computed for each texel.
_AZIMUTHS = 48

# W / (m2 nm), outside of the atmosphere.
_SUN = np.array([1.679, 1.828, 1.986, 1.307])
# 1 / km at sea level (Bucholtz, 1995).
_AIR = np.array([6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2])
# m2 a molecule (Gorshelev et al., 2014), and the mean thickness of the layer in Dobson units.
_OZONE = np.array([3.472e-25, 3.914e-25, 1.349e-25, 1.103e-26])
_DOBSON = 334.5
# Of aerosols over towns: cross sections, density at the ground, that of the background, and the
# height in which it falls to 1 / e.
_ABSORBED = np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23])
_SCATTERED = np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22])
_DENSITY, _BACKGROUND, _HEIGHT = 1.3681e20, 2e6, 0.73
_ASYMMETRY = 0.8
_GROUND_ALBEDO = 0.3
# Light scattered more than once, relative to the sun's: a fit.
_REPEATED = 0.02 * np.array([0.217, 0.347, 0.594, 1.0])
# CIE XYZ (rows) of the four wavelengths' radiances.
_SPECTRAL_TO_XYZ = np.array(
    [
        [53.38691773856467, 43.904844466369358, 1.6137278251608962, 20.762668673810577],
        [22.981337506691025, 71.347795700053394, 18.422960591455485, 2.3614213523314369],
        [0.0, 0.10250686796574131, 31.742921188390806, 110.48009643252140],
    ]
)


def _coefficients(atmosphere, height):
    """Return what happens to light in a km.

    Parameters
    ----------
    atmosphere : Atmosphere
    height : ndarray of shape (...)
        Above the ground, km.

    Returns
    -------
    by_air, by_aerosols, extinction : ndarray of shape (..., 4)
        Light scattered by air, by aerosols, and all that is lost, 1 / km.
    """
    h = np.maximum(height, 0.0)[..., None]
    by_air = atmosphere.air * _AIR * np.exp(-0.07771971 * h**1.16364243)
    log = np.log(h + 1e-4) - 3.22261
    layer = 3.78547397e20 / (h + 1e-4) * np.exp(-log * log * 5.55555555)
    ozone = atmosphere.ozone * _OZONE * _DOBSON * layer
    density = atmosphere.aerosols * _DENSITY * (np.exp(-h / _HEIGHT) + _BACKGROUND / _DENSITY)
    by_aerosols = _SCATTERED * density
    return by_air, by_aerosols, by_air + ozone + by_aerosols + _ABSORBED * density


# Memo of its arguments alone.
@cache
def _transmittances(atmosphere):
    """Return shares of light that pass to the end of the atmosphere, by height and cosine."""
    cosine = np.linspace(-1.0, 1.0, _TABLE_COLUMNS)
    height = np.linspace(0.0, _THICKNESS, _TABLE_ROWS)
    return np.exp(-_depth(atmosphere, height[:, None], cosine[None])).astype(np.float32)


def _depth(atmosphere, height, cosine):
    radius = _EARTH_RADIUS + height
    step = to_sphere(radius, cosine, _EARTH_RADIUS + _THICKNESS) / _STEPS
    total = 0.0
    for i in range(_STEPS):
        r = distance_after(radius, (i + 0.5) * step, cosine)
        total = total + _coefficients(atmosphere, r - _EARTH_RADIUS)[2] * step[..., None]
    return total


def _look_up(table, cosine, height):
    """Return the table's values between its texels, shape (..., 4)."""
    rows, columns = table.shape[:2]
    x = np.clip(cosine * 0.5 + 0.5, 0.0, 1.0) * (columns - 1)
    y = np.clip(height / _THICKNESS, 0.0, 1.0) * (rows - 1)
    i, j = (np.minimum(v.astype(np.int32), n - 2) for v, n in ((x, columns), (y, rows)))
    s, t = (x - i)[..., None], (y - j)[..., None]
    flat = table.reshape(-1, 4)
    first = j * columns + i
    low = flat[first] + s * (flat[first + 1] - flat[first])
    high = flat[first + columns] + s * (flat[first + columns + 1] - flat[first + columns])
    return low + t * (high - low)


def radiance(atmosphere, altitude, sun_elevation, elevation, azimuth):
    """Return the light of the sky, without the sun's disc.

    Parameters
    ----------
    atmosphere : Atmosphere
    altitude : float
        Of the eye, m.
    sun_elevation : float
        Radians.
    elevation : ndarray of shape (H,)
    azimuth : ndarray of shape (W,)
        From the sun, radians.

    Returns
    -------
    ndarray of shape (H, W, 3)
        CIE XYZ.
    """
    radius = _EARTH_RADIUS + _height(altitude)
    sums = _sums(atmosphere, radius, sun_elevation, elevation, coarse_azimuths(_AZIMUTHS))
    by_air, by_aerosols, repeated = (
        between_azimuths(part.astype(np.float32), azimuth) for part in sums
    )
    cosine = cosines_to_sun(sun_elevation, elevation, azimuth)[..., None]
    g2 = _ASYMMETRY**2
    spread = 1.0 + g2 - 2.0 * _ASYMMETRY * cosine
    phase_of_aerosols = (1.0 - g2) / (4.0 * np.pi * spread * np.sqrt(spread))
    light = phase_of_air(cosine) * by_air + phase_of_aerosols * by_aerosols + repeated
    return (_SUN * light) @ _SPECTRAL_TO_XYZ.T


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
    place = np.array([np.sin(elevation)]), np.array([_height(altitude)])
    return _SPECTRAL_TO_XYZ @ (_SUN * _look_up(_transmittances(atmosphere), *place))[0]


def _height(altitude):
    """Return an eye's altitude in km."""
    return min(max(altitude, 1.0), _HIGHEST) / 1000.0


def _sums(atmosphere, radius, sun_elevation, elevation, azimuth):
    """Return light scattered towards the eye along rays, phases left out: 3 of (H, W, 4)."""
    table = _transmittances(atmosphere)
    cosine = np.sin(elevation)
    ground = radius**2 * (1.0 - cosine**2) < _EARTH_RADIUS**2
    ground &= cosine < 0.0
    way = to_sphere(radius, cosine, _EARTH_RADIUS + _THICKNESS)
    near = -radius * cosine - np.sqrt(
        np.maximum(_EARTH_RADIUS**2 - radius**2 * (1.0 - cosine**2), 0.0)
    )
    step = np.where(ground, near, way) / _STEPS
    passed = np.ones((len(elevation), 4))
    sums = [np.zeros((len(elevation), len(azimuth), 4)) for _ in range(3)]
    for i in range(_STEPS):
        distance, sun = points_on_rays(radius, (i + 0.5) * step, sun_elevation, elevation, azimuth)
        height = distance - _EARTH_RADIUS
        by_air, by_aerosols, lost = _coefficients(atmosphere, height)
        heights = np.broadcast_to(height[:, None], sun.shape)
        lit = _look_up(table, sun, heights)
        repeated = _repeated(table, sun, heights, distance[:, None])
        left = np.exp(-step[:, None] * lost)
        weight = passed * (1.0 - left) / np.maximum(lost, 1e-7)
        sums[0] += (weight * by_air)[:, None] * lit
        sums[1] += (weight * by_aerosols)[:, None] * lit
        sums[2] += (weight * (by_air + by_aerosols))[:, None] * repeated
        passed = passed * left
    return sums


def _repeated(table, sun, height, distance):
    """Return light of the ground and light scattered before, a unit of the sun's."""
    seen = 2.0 * np.pi * (1.0 - np.sqrt(np.maximum(distance**2 - _EARTH_RADIUS**2, 0.0)) / distance)
    at_ground = _look_up(table, sun, np.zeros_like(sun))
    upwards = np.ones_like(height[:, :1])
    rising = _look_up(table, upwards, 0.0 * upwards) / _look_up(table, upwards, height[:, :1])
    ground = (seen * sun)[..., None] * (_GROUND_ALBEDO / (4.0 * np.pi**2)) * at_ground * rising
    return ground + _REPEATED / (1.0 + 5.0 * np.exp(-17.92 * sun))[..., None]
