"""The lens' opening for the splat: its light density in layers of rising blur.

A disc in the picture is blurred by the pixel filter and by the extent of its source. Both are
small beside a large disc and large beside a small one, so the opening is kept at several blurs:
layer l is blurred by a tent with the variance of a box of width ``w = 2^l / 128`` radii, and spans
``[-e, e]``, ``e = 1 + w / sqrt(2)``. It holds the light per unit of area, so that its integral is
the share of light that passes: 1 for an opening without vignetting.
"""

import numpy as np

from ..openings.masks import texel_centres

# Must agree with lib/bokeh/opening_lib.glsl.
LEAST_BLUR = 1.0 / 128.0
LAYERS = 8
# Texels of a supersampled mask along the opening's diameter, and least ones of a tent's half width.
_MASK = 1024
_TENT = 16


def extent(layer):
    """Return the half width of a layer, in units of the opening's radius."""
    return 1.0 + LEAST_BLUR * 2.0**layer / np.sqrt(2.0)


def opening_layers(coverage, size=512, layers=LAYERS):
    """Make the layers of an opening.

    Parameters
    ----------
    coverage : callable
        From places, shape (..., 2) in units of the radius, and the side of a texel there to the
        share of light that passes, shape (...) or (..., channels). Nothing passes beyond 1 radius.
    size : int
        Texels along a side of a layer.
    layers : int

    Returns
    -------
    ndarray of shape (layers, size, size, 4)
        float32, row 0 at the bottom; red, green, blue and nothing. Each colour's integral is that
        of the coverage over the largest of the three.
    """
    mask = np.asarray(coverage(texel_centres(_MASK), 2.0 / _MASK), dtype=float)
    return layers_of_mask(mask.reshape(_MASK, _MASK, -1), range(layers), size)


def layers_of_mask(mask, layers, size=512):
    """Make layers of an opening from its mask.

    Parameters
    ----------
    mask : ndarray of shape (M, M, channels)
        Means over the texels of a square from -1 to 1; M a power of 2.
    layers : sequence of int
    size : int
        Texels along a side of a layer.

    Returns
    -------
    ndarray of shape (layers, size, size, 4)
        As of `opening_layers`.
    """
    channels = [0, 1, 2] if mask.shape[-1] >= 3 else [0, 0, 0]
    integral = mask.sum(axis=(0, 1))
    share = integral / integral.max()
    result = np.zeros((len(layers), size, size, 4), np.float32)
    for i, layer in enumerate(layers):
        blurred = _blurred(mask, LEAST_BLUR * 2.0**layer / np.sqrt(2.0), extent(layer), size)
        texel = 2.0 * extent(layer) / size
        total = blurred.sum(axis=(0, 1)) * texel**2
        density = blurred * (share / np.maximum(total, 1e-30))
        result[i, ..., :3] = density[..., channels]
    return result


def _blurred(mask, width, reach, size):
    """Return the means of a mask over tents round the texels of a layer, axis by axis.

    A tent is a box convolved with itself. The interpolation between the layer's texels, which
    blurs a little more, is not part of it.
    """
    while width * len(mask) / 2.0 > 2 * _TENT:
        mask = 0.25 * (mask[::2, ::2] + mask[1::2, ::2] + mask[::2, 1::2] + mask[1::2, 1::2])
    places, weights = _tent(len(mask), width, reach, size)
    # Whole rows are taken, along either axis: several times as fast as texels.
    for _ in range(2):
        rows = sum(mask[at] * w[:, None, None] for at, w in zip(places, weights, strict=True))
        mask = np.ascontiguousarray(rows.swapaxes(0, 1))
    return mask


def _tent(count, width, reach, size):
    """Return which texels of a mask a tent covers, and with which weights.

    Parameters
    ----------
    count : int
        Texels of the mask, over [-1, 1].
    width : float
        Half width of the tent.
    reach : float
        Of the layer, from the centre.
    size : int
        Texels of the layer.

    Returns
    -------
    places, weights : ndarray of shape (K, size)
    """
    centers = (np.arange(size) + 0.5) * (2.0 * reach / size) - reach
    first = np.floor((centers - width + 1.0) * count / 2.0).astype(int)
    places = first + np.arange(int(np.ceil(width * count)) + 2)[:, None]
    edges = np.stack([places, places + 1]) * (2.0 / count) - 1.0
    # The integral of the tent from its left end on.
    t = np.clip((edges - centers) / width, -1.0, 1.0)
    integral = np.where(t < 0.0, 0.5 * (1.0 + t) ** 2, 1.0 - 0.5 * (1.0 - t) ** 2)
    inside = (places >= 0) & (places < count)
    return np.clip(places, 0, count - 1), np.where(inside, integral[1] - integral[0], 0.0)
