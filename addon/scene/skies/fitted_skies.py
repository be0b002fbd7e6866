"""Skies of formulas that were fitted to simulations: Preetham's and Hosek and Wilkie's.

Both give the light of a direction from its angle to the zenith, `theta`, and its angle to the sun,
`gamma`, in radians.

References
----------
Preetham, Shirley and Smits, A practical analytic model for daylight, SIGGRAPH 1999.
Hosek and Wilkie, An analytic model for full spectral sky-dome radiance, SIGGRAPH 2012.
"""

import json
from functools import cache
from pathlib import Path

import numpy as np

# Blender's units of radiance: of Preetham's kcd / m2, and of Hosek and Wilkie's W / m2.
_PREETHAM_SCALE = 0.06
_HOSEK_SCALE = 2.0 * np.pi / 683.0
# Directions below are as bright as this close above the horizon.
_LEAST_ELEVATION = 1e-3


def preetham(turbidity, sun_theta, theta, gamma):
    """Return CIE XYZ of Preetham's sky.

    Parameters
    ----------
    turbidity, sun_theta : float
    theta, gamma : ndarray of shape (...)

    Returns
    -------
    ndarray of shape (..., 3)
    """
    t, s = turbidity, sun_theta
    powers = np.array([s**3, s**2, s, 1.0])
    haze = np.array([t * t, t, 1.0])
    chi = (4.0 / 9.0 - t / 120.0) * (np.pi - 2.0 * s)
    zenith = np.array(
        [
            _PREETHAM_SCALE * ((4.0453 * t - 4.9710) * np.tan(chi) - 0.2155 * t + 2.4192),
            haze @ _ZENITH_X @ powers,
            haze @ _ZENITH_Y @ powers,
        ]
    )
    shapes = _SLOPES * t + _OFFSETS
    theta = np.minimum(theta, 0.5 * np.pi - _LEAST_ELEVATION)
    luminance, x, y = (
        level * _perez(shape, theta, gamma) / _perez(shape, 0.0, s)
        for level, shape in zip(zenith, shapes, strict=True)
    )
    return np.stack([x / y * luminance, luminance, (1.0 - x - y) / y * luminance], axis=-1)


# Chromaticities at the zenith: rows of the turbidity's powers 2, 1, 0; columns of the sun's 3 to 0.
_ZENITH_X = np.array(
    [
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]
)
_ZENITH_Y = np.array(
    [
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]
)
# Perez' five numbers of Y, x and y, linear in the turbidity.
_SLOPES = np.array(
    [
        [0.1787, -0.3554, -0.0227, 0.1206, -0.0670],
        [-0.0193, -0.0665, -0.0004, -0.0641, -0.0033],
        [-0.0167, -0.0950, -0.0079, -0.0441, -0.0109],
    ]
)
_OFFSETS = np.array(
    [
        [-1.4630, 0.4275, 5.3251, -2.5771, 0.3703],
        [-0.2592, 0.0008, 0.2125, -0.8989, 0.0452],
        [-0.2608, 0.0092, 0.2102, -1.6537, 0.0529],
    ]
)


def _perez(shape, theta, gamma):
    a, b, c, d, e = shape
    falling = 1.0 + a * np.exp(b / np.cos(theta))
    return falling * (1.0 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2)


def hosek_wilkie(turbidity, albedo, sun_theta, theta, gamma):
    """Return CIE XYZ of Hosek and Wilkie's sky.

    Parameters
    ----------
    turbidity : float
        1 to 10.
    albedo : float
        Of the ground, 0 to 1.
    sun_theta : float
    theta, gamma : ndarray of shape (...)

    Returns
    -------
    ndarray of shape (..., 3)
    """
    shapes, levels = _hosek_table()
    t = np.clip(turbidity, 1.0, 10.0)
    low = min(int(t), 9)
    height = (max(0.5 * np.pi - sun_theta, 0.0) / (0.5 * np.pi)) ** (1.0 / 3.0)
    bernstein = np.array([1, 5, 10, 10, 5, 1]) * (
        height ** np.arange(6) * (1.0 - height) ** np.arange(5, -1, -1)
    )
    weights = np.outer([1.0 - albedo, albedo], [1.0 - (t - low), t - low])
    shape = np.einsum("cabes,ab,e->cs", shapes[:, :, low - 1 : low + 1], weights, bernstein)
    level = np.einsum("cabe,ab,e->c", levels[:, :, low - 1 : low + 1], weights, bernstein)
    theta = np.minimum(theta, 0.5 * np.pi - _LEAST_ELEVATION)
    up, along = np.cos(theta), np.cos(gamma)
    channels = []
    for brightness, (a, b, c, d, e, f, g, i, h) in zip(level, shape, strict=True):
        glow = (1.0 + along**2) / (1.0 + h * h - 2.0 * h * along) ** 1.5
        bright = c + d * np.exp(e * gamma) + f * along**2 + g * glow + i * np.sqrt(up)
        channels.append(brightness * (1.0 + a * np.exp(b / (up + 0.01))) * bright)
    return _HOSEK_SCALE * np.stack(channels, axis=-1)


# Memo of no arguments: a file that comes with the extension.
@cache
def _hosek_table():
    """Return the fitted numbers: shapes (3, 2, 10, 6, 9) and levels (3, 2, 10, 6).

    By channel (X, Y, Z), albedo (0, 1), turbidity (1 to 10), height of the sun.
    """
    text = Path(__file__).with_name("hosek_wilkie.json").read_text(encoding="utf-8")
    numbers = json.loads(text)
    return np.array(numbers["shapes"]), np.array(numbers["levels"])
