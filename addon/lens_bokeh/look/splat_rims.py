"""Energy of a splat under analytic vignetting, by which the shader divides to keep its energy.

A splat is the product of opening, profile and rims (`lens_bokeh.look.vignetting_model`). Its energy
depends on the tangent of the chief ray's angle, on its azimuth where the opening is not
round, on the blur and on the row of the profile. Along rings of the opening the integral over the
azimuth is a circular correlation of the opening with the rims: one Fourier transform gives all
azimuths.
"""

import numpy as np

from . import vignetting_model
from .opening import LEAST_BLUR, extent

TANGENTS, AZIMUTHS, MOST_ROWS = 33, 128, 17
_RINGS = 192
# Least width of a rim's edge, as a share of the layer's half width; as in
# lib/bokeh/bokeh_look_lib.glsl.
EDGES = 96.0
# Least share that is divided by: discs of which hardly anything is left stay dark.
_LEAST_LIGHT = 1e-3


def light_left(rims, opening, profile, largest_tangent):
    """Share of a splat's light that passes the rims.

    Parameters
    ----------
    rims : sequence of Rim
    opening : ndarray of shape (layers, size, size, 4)
        From `opening_layers`.
    profile : ndarray of shape (layers, rows, radii, 4) or None
        From `profile_layers`.
    largest_tangent : float
        Of the chief ray's angle, > 0.

    Returns
    -------
    ndarray of shape (layers * R, AZIMUTHS + 1, TANGENTS, 4)
        float32; R rows of the profile, even from the first to the last (1 without a profile). The
        azimuth goes once round, anticlockwise from x; tangents rise from 0.
    """
    rows = 1 if profile is None else min(MOST_ROWS, profile.shape[1])
    azimuth = (np.arange(AZIMUTHS) + 0.5) * (2.0 * np.pi / AZIMUTHS)
    result = np.empty((len(opening), rows, AZIMUTHS + 1, TANGENTS, 4), np.float32)
    for layer, light in enumerate(opening):
        reach, width = extent(layer), LEAST_BLUR * 2.0**layer
        polar = np.fft.rfft(_polar(light, reach), axis=-1)
        rings = (np.arange(_RINGS) + 0.5) / _RINGS * reach
        factors = _factors(profile, layer, rows, rings, reach)
        whole = np.einsum("crk,ck->cr", factors, polar[..., 0].real)
        places = rings[:, None, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
        for i, tangent in enumerate(np.linspace(0.0, largest_tangent, TANGENTS)):
            edge = max(width, reach / EDGES)
            passing = vignetting_model.transmission(rims, places, (tangent, 0.0), edge)
            turned = np.fft.irfft(polar * np.conj(np.fft.rfft(passing, axis=-1)), AZIMUTHS, axis=-1)
            left = np.einsum("crk,cka->cra", factors, turned) / np.maximum(whole, 1e-30)[..., None]
            left = np.clip(left, _LEAST_LIGHT, 1.0)
            result[layer, :, :AZIMUTHS, i, :3] = np.moveaxis(left, 0, -1)
    result[:, :, AZIMUTHS] = result[:, :, 0]
    result[..., 3] = 0.0
    return result.reshape(-1, AZIMUTHS + 1, TANGENTS, 4)


def _polar(light, reach):
    """Light of a layer in cells of rings and azimuths, shape (3, _RINGS, AZIMUTHS)."""
    size = len(light)
    axis = (np.arange(size) + 0.5) * (2.0 * reach / size) - reach
    x, y = axis, axis[:, None]
    ring = np.minimum((np.hypot(x, y) / reach * _RINGS).astype(int), _RINGS)
    turn = np.mod(np.arctan2(y, x + 0.0 * y) / (2.0 * np.pi), 1.0) * AZIMUTHS
    cell = ring * AZIMUTHS + np.minimum(turn.astype(int), AZIMUTHS - 1)
    count = (_RINGS + 1) * AZIMUTHS
    cells = [np.bincount(cell.ravel(), light[..., c].ravel(), count) for c in range(3)]
    # The corners of the square, beyond the last ring, are dark.
    return np.stack(cells).reshape(3, _RINGS + 1, AZIMUTHS)[:, :_RINGS]


def _factors(profile, layer, rows, rings, reach):
    """Profile at the rings, shape (3, rows, _RINGS)."""
    if profile is None:
        return np.ones((3, 1, len(rings)))
    place = np.linspace(0.0, profile.shape[1] - 1.0, rows)
    low = np.minimum(place.astype(int), profile.shape[1] - 2)
    t = (place - low)[:, None, None]
    picked = (1.0 - t) * profile[layer, low, :, :3] + t * profile[layer, low + 1, :, :3]
    at = (np.arange(profile.shape[2]) + 0.5) / profile.shape[2] * reach
    return np.array([[np.interp(rings, at, row[:, c]) for row in picked] for c in range(3)])
