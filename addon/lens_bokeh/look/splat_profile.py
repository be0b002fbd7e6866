"""The bokeh profile of a lens for the splat: over depth and radius, in layers of rising blur.

A splat multiplies the opening (`lens_bokeh.look.opening`) by the profile. Both are blurred by the
pixel filter and the extent of the source: the same layer of both is read. The opening has the rim,
so the profile is continued beyond it: otherwise the rim would be blurred twice. Each row of each
layer is then scaled so that opening times profile has the opening's energy, channel by channel.
Layers and rows are interpolated linearly, which keeps that.

Rows run over ``w = c / (|c| + c0)`` of the signed circle of confusion as in
`lens_bokeh.tables.mapping`. Lengths on the sensor become pixels by the ratio of the renderer's
circle of confusion to the lens' own: both have the form ``k (1 - d_f / d)`` with distances from the
entrance pupil, so that the picture keeps the camera's field of view and blur and takes the lens'
patterns.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..tables.mapping import frame_table
from ..tables.radial_energy import ring_energy
from .opening import LEAST_BLUR, extent
from .sprite import edge_landing

RADII = 256
# Rows, evenly spaced in w: patterns change fast where they are as small as the lens' aberrations.
_ROWS = 128
_EDGE_RAYS = 1025
# Half width of a layer below which its rim is steep within a texel, so that it is interpolated.
_SMOOTH_REACH = 1.0 + 8.0 * LEAST_BLUR * 0.7
_MM = 1000.0


@dataclass(frozen=True, eq=False)
class DepthRows:
    """Radial patterns over depth.

    Parameters
    ----------
    density : ndarray of shape (rows, RADII, channels)
        Each integrates to 1 over the unit disk; 1 or 3 channels.
    extents : ndarray of shape (rows,)
        Radius of the pattern over ``|c| + c0``.
    w_range : tuple of 2 float
        w of the first and of the last row, rising.
    soft : float
        c0 over the circle of confusion of a point at infinity; not negative.
    """

    density: np.ndarray
    extents: np.ndarray
    w_range: tuple[float, float]
    soft: float


def rows_of_edge(edge):
    """Rows of a thin lens with spherical aberration.

    Parameters
    ----------
    edge : float
        As in `Appearance`.

    Returns
    -------
    DepthRows
        Two rows: in front of the focus and behind it.
    """
    edges = np.linspace(0.0, 1.0, RADII + 1)
    pupil = np.linspace(0.0, 1.0, _EDGE_RAYS)
    areas = np.pi * np.diff(edges**2)
    rows = [ring_energy(edge_landing(side, pupil), pupil, edges) / areas for side in (-edge, edge)]
    density = np.stack(rows)[..., None] / np.pi
    return DepthRows(density, np.ones(2), (-1.0, 1.0), 0.0)


def rows_of_lens(profile, focus_distance, f_number):
    """Rows of a real lens.

    Parameters
    ----------
    profile : LensProfile
    focus_distance : float
        From the camera, which is taken as the centre of the entrance pupil, m.
    f_number : float

    Returns
    -------
    DepthRows

    Raises
    ------
    FocusError
        If the lens cannot be focused there.
    """
    table = frame_table(profile, distance_from_h(profile, focus_distance), f_number, _ROWS, RADII)
    order = slice(None) if table.w_range[0] < table.w_range[1] else slice(None, None, -1)
    w_range = tuple(sorted(table.w_range))
    return DepthRows(
        table.density[order], table.extents[order], w_range, table.soft_blur / abs(table.blur[0])
    )


def distance_from_h(profile, from_pupil):
    """Return a distance from the first principal plane.

    Parameters
    ----------
    profile : LensProfile
    from_pupil : float
        Distance from the centre of the entrance pupil, m.

    Returns
    -------
    float
        mm.
    """
    distance = from_pupil * _MM
    # The pupil moves with a focus group, but little compared with the distance.
    for _ in range(8):
        state = profile.focused(distance)
        distance = from_pupil * _MM - (state.ray_map.pupil - state.first_order.h)
    return distance


def light_on_radii(opening):
    """Return the `radial_weights` of an opening's layers.

    Parameters
    ----------
    opening : ndarray of shape (layers, size, size, 4)
        From `opening_layers`.

    Returns
    -------
    list of ndarray of shape (3, RADII)
    """
    return [radial_weights(light, extent(layer)) for layer, light in enumerate(opening)]


def profile_layers(rows, opening, strength=1.0, weights=None):
    """Make the layers of a profile.

    Parameters
    ----------
    rows : DepthRows
    opening : ndarray of shape (layers, size, size, 4)
        From `opening_layers`.
    strength : float
        0: even discs, 1: the profile.
    weights : list of ndarray, optional
        `light_on_radii` of the opening, where it is known already.

    Returns
    -------
    ndarray of shape (layers, rows, RADII, 4)
        float32. Red, green and blue: factors of the opening at radii of 0 to the layer's extent.
        The fourth: the radius of the pattern over ``|c| + c0``.
    """
    channels = [0, 1, 2] if rows.density.shape[-1] == 3 else [0, 0, 0]
    density = np.moveaxis(rows.density, -1, 0)[channels].astype(float)
    density = 1.0 - strength + strength * np.pi * density
    result = np.empty((len(opening), len(rows.extents), RADII, 4), np.float32)
    result[..., 3] = rows.extents[:, None]
    for layer, light in enumerate(weights or light_on_radii(opening)):
        reach = extent(layer)
        width = LEAST_BLUR * 2.0**layer
        factors = np.maximum(density @ _blur(width, reach).T, 0.0)
        energy = np.einsum("crj,cj->cr", factors, light)
        factors *= (light.sum(axis=1)[:, None] / np.maximum(energy, 1e-30))[..., None]
        result[layer, ..., :3] = np.moveaxis(factors, 0, -1)
    return result


def radial_weights(light, reach):
    """Light of an opening's layer at the radii of a profile's texels.

    Parameters
    ----------
    light : ndarray of shape (size, size, 4)
    reach : float
        Of the layer.

    Returns
    -------
    ndarray of shape (3, RADII)
        Sums to the layer's light; shares are those of linear interpolation.
    """
    channels = 3 if np.ptp(light[..., :3], axis=-1).any() else 1
    light = _finer(light[..., :channels]) if reach < _SMOOTH_REACH else light
    size = len(light)
    axis = (np.arange(size) + 0.5) * (2.0 * reach / size) - reach
    radius = np.hypot(axis, axis[:, None]).ravel()
    at = np.clip(radius / reach * RADII - 0.5, 0.0, RADII - 1.0)
    low = np.minimum(at.astype(int), RADII - 2)
    upper = at - low
    texel = (2.0 * reach / size) ** 2
    result = np.empty((3, RADII))
    for channel in range(channels):
        energy = light[..., channel].ravel() * texel
        result[channel] = np.bincount(low, energy * (1.0 - upper), minlength=RADII)
        result[channel] += np.bincount(low + 1, energy * upper, minlength=RADII)
    result[channels:] = result[0]
    return result


def _finer(light):
    """Upsample a picture three times by linear interpolation, as its rim is steep."""
    shares = np.array([1.0, 0.0, 1.0]) / 3.0
    for axis in (0, 1):
        light = np.moveaxis(light, axis, 0)
        below = np.concatenate([light[:1], light[:-1]])
        above = np.concatenate([light[1:], light[-1:]])
        parts = [
            light * (1.0 - share) + other * share
            for share, other in zip(shares, (below, light, above), strict=True)
        ]
        light = np.stack(parts, axis=1).reshape(-1, *light.shape[1:])
        light = np.moveaxis(light, 0, axis)
    return light


# Memo of its arguments alone: one for each layer.
@lru_cache(maxsize=16)
def _blur(width, reach):
    """Matrix that blurs a radial function on rings, as it is read at the texels of a layer."""
    # A Gaussian with the variance of a box of this width; texels are no finer than half a ring.
    sigma = max(width / np.sqrt(12.0), 0.5 / RADII)
    rings = (np.arange(int(RADII * (reach + 3.0 * sigma)) + 1) + 0.5) / RADII
    at = (np.arange(RADII) + 0.5) / RADII * reach
    product = at[:, None] * rings / sigma**2
    kernel = rings * np.exp(-0.5 * ((at[:, None] - rings) / sigma) ** 2) * _bessel(product)
    kernel /= kernel.sum(axis=1, keepdims=True)
    # Beyond the rim the outermost ring goes on.
    result = kernel[:, :RADII].copy()
    result[:, -1] += kernel[:, RADII:].sum(axis=1)
    return result


def _bessel(x):
    """Return the modified Bessel function of order 0 times exp(-x)."""
    small = np.minimum(x, 30.0)
    large = np.maximum(x, 30.0)
    series = 1.0 + 1.0 / (8.0 * large) + 9.0 / (128.0 * large**2) + 225.0 / (3072.0 * large**3)
    return np.where(x < 30.0, np.i0(small) * np.exp(-small), series / np.sqrt(2.0 * np.pi * large))
