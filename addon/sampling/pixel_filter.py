"""Pixel filters, importance sampled: a sample is moved inside the filter.

A pixel may be drawn as a grid of sub-pixels that share one movement. A sub-pixel then lands where
the filter would not have put it as often, and is weighted by the filter's density over the density
of the whole grid's places (the balance heuristic), which keeps the filter exact.

Blender's filter size means the whole support of a box, but half of it for Blackman-Harris, in
Cycles and EEVEE alike (measured: a point's image through Cycles at size 4 has the variance of
support 8).
"""

import numpy as np

# The table's resolution: its error in position is below 1/1000 of the filter width.
_TABLE_SIZE = 2048

# Most sub-pixels along a side of a pixel: two vectors of weights hold as many.
MOST_SUBPIXELS = 4

# Four-term Blackman-Harris window, Harris, Proc. IEEE 66(1), 1978, table of windows.
_COEFFICIENTS = (0.35875, -0.48829, 0.14128, -0.01168)

# Of the window on [-1/2, 1/2].
_VARIANCE = (
    1.0 / 12.0
    + sum(c / (2.0 * np.pi**2 * k**2) for k, c in enumerate(_COEFFICIENTS) if k) / _COEFFICIENTS[0]
)


def blackman_harris(x):
    """Four-term Blackman-Harris window on [-1/2, 1/2].

    Parameters
    ----------
    x : ndarray of shape (...)

    Returns
    -------
    ndarray of shape (...)
        1 at the centre, 0 outside.
    """
    angle = 2 * np.pi * (np.asarray(x) + 0.5)
    value = sum(c * np.cos(k * angle) for k, c in enumerate(_COEFFICIENTS))
    return np.where(np.abs(x) <= 0.5, value, 0.0)


def filter_density(offset, kind, size_px):
    """Density of a pixel filter along one axis.

    Parameters
    ----------
    offset : ndarray of shape (...)
        From the pixel's centre, in pixels.
    kind : {'BLACKMAN_HARRIS', 'BOX'}
    size_px : float
        Blender's filter size, in pixels.

    Returns
    -------
    ndarray of shape (...)
        Per pixel; integrates to 1.
    """
    if kind == "BOX":
        # Half open, so that neighbouring boxes share no place; the margin is for rounding.
        half = 0.5 * size_px
        inside = (offset >= -half - 1e-9) & (offset < half - 1e-9)
        return np.where(inside, 1.0 / size_px, 0.0)
    width = 2.0 * size_px
    # The window's integral is its constant term.
    return blackman_harris(np.asarray(offset) / width) / (_COEFFICIENTS[0] * width)


def filter_support(kind, size_px):
    """Return the full width of a pixel filter, in pixels."""
    return size_px if kind == "BOX" else 2.0 * size_px


def subpixel_centers(count):
    """Return the centres of `count` sub-pixels along a pixel, from its centre, in pixels."""
    return (np.arange(count) + 0.5) / count - 0.5


def movement_size(kind, size_px, subpixels):
    """Return the size of the filter that moves a grid of sub-pixels.

    A box is narrowed by the grid's own extent: a box of one pixel then needs no weights at all.
    """
    if kind == "BOX":
        return max(size_px - (subpixels - 1) / subpixels, 1.0 / subpixels)
    return size_px


def subpixel_weights(offsets, kind, size_px, subpixels):
    """Return the weights of sub-pixels along one axis that make a jittered grid an exact filter.

    Parameters
    ----------
    offsets : ndarray of shape (N,)
        Movements of the grid drawn with `movement_size`, in pixels.
    kind : {'BLACKMAN_HARRIS', 'BOX'}
    size_px : float
        Blender's filter size, in pixels.
    subpixels : int
        Along the axis.

    Returns
    -------
    ndarray of shape (N, subpixels)
        Their expected sum is 1. The weight of a sub-pixel is the product of its two axes'.

    References
    ----------
    Veach and Guibas, Optimally combining sampling techniques, SIGGRAPH 1995.
    """
    offsets = np.asarray(offsets, dtype=np.float64)
    if subpixels == 1:
        return np.ones((len(offsets), 1))
    centers = subpixel_centers(subpixels)
    places = offsets[:, None] + centers
    moved = movement_size(kind, size_px, subpixels)
    mixture = filter_density(places[:, :, None] - centers, kind, moved).sum(axis=-1)
    density = filter_density(places, kind, size_px)
    return np.where(density > 0.0, density / np.maximum(mixture, 1e-12), 0.0)


def filter_offsets(uniform, kind, size_px):
    """Importance-sample a pixel filter: map uniform numbers to offsets from the pixel's centre.

    Parameters
    ----------
    uniform : ndarray of shape (..., 2)
        In [0, 1); 0.5 becomes the pixel's centre.
    kind : {'BLACKMAN_HARRIS', 'BOX'}
    size_px : float
        Blender's filter size, in pixels.

    Returns
    -------
    ndarray of shape (..., 2)
        Offsets from the pixel's centre, in pixels.
    """
    uniform = np.asarray(uniform, dtype=np.float64)
    if kind == "BOX":
        return (uniform - 0.5) * size_px
    edges = np.linspace(-0.5, 0.5, _TABLE_SIZE + 1)
    density = blackman_harris(0.5 * (edges[1:] + edges[:-1]))
    cumulative = np.concatenate([[0.0], np.cumsum(density)])
    return np.interp(uniform, cumulative / cumulative[-1], edges) * 2.0 * size_px


def texel_offsets(uniform, kind, size_px):
    """Importance-sample a pixel filter for a picture that is looked up by the nearest texel.

    A texel has one colour all over its square, whose place in the pixel differs from sample to
    sample: that is a box of a pixel on top of where the picture is looked up. Places drawn here
    are so much nearer to the pixel's centre that both together have the filter's variance. A box
    as wide as a whole number of pixels is met exactly. The share of an edge's light on either side
    is met to 0.005 for Blackman-Harris of size 1.5 and to 0.001 from 2 on. A filter that is
    narrower than a texel leaves the centre alone.

    Parameters and result are those of `filter_offsets`.
    """
    if kind == "BOX":
        # Boxes of a pixel side by side, or overlapping.
        boxes = max(int(np.ceil(size_px - 1e-9)), 1)
        step = np.sqrt(max(size_px**2 - 1.0, 0.0) / max(boxes**2 - 1.0, 1.0))
        place = np.minimum(np.floor(np.asarray(uniform) * boxes), boxes - 1)
        return step * (place - 0.5 * (boxes - 1))
    left = size_px**2 - 1.0 / (48.0 * _VARIANCE)
    return filter_offsets(uniform, kind, np.sqrt(max(left, 0.0)))
