"""The sample sequence of a frame: places on the lens and offsets in the pixel.

Lens: Halton bases (2, 7); pixel: bases (3, 5). Base 11 is kept for the wavelength (methods 2, 8).
The sequence is shifted by one half in every dimension, which makes its first element the lens'
centre and the pixel's centre: the first sample of a progressive picture is the pinhole picture.
"""

import numpy as np

from .halton import halton
from .iris import iris_points
from .pixel_filter import filter_offsets, movement_size, texel_offsets

LENS_BASES = (2, 7)
PIXEL_BASES = (3, 5)
# Ratio of the plastic sequence: the real root of x^3 = x + 1.
_PLASTIC = 1.3247179572447460


def _shift(seed, dimensions, stream):
    if seed == 0:
        return 0.5
    return 0.5 + np.random.default_rng([seed, stream]).random(dimensions)


def lens_samples(first, count, iris, seed=0, rotation=0.0):
    """Return positions on the iris for samples `first` to `first + count - 1`.

    Parameters
    ----------
    first, count : int
    iris : Iris
    seed : int
        0 is the plain sequence; others rotate it on the torus.
    rotation : float or array_like of shape (2,)
        A further rotation.

    Returns
    -------
    ndarray of shape (count, 2)
        In units of the aperture radius.
    """
    shift = _shift(seed, 2, 1) + np.asarray(rotation)
    return iris_points(halton(first, count, LENS_BASES, shift), iris)


def pixel_offsets(first, count, kind, size_px, seed=0, subpixels=1):
    """Return offsets in the pixel (jitter) for samples `first` to `first + count - 1`.

    Parameters
    ----------
    first, count : int
    kind : {'BLACKMAN_HARRIS', 'BOX'}
    size_px : float
    seed : int
    subpixels : int
        Sub-pixels along each side of a pixel; the grid moves as a whole.

    Returns
    -------
    ndarray of shape (count, 2)
        Offsets from the pixel's centre, in pixels, x right and y up.
    """
    uniform = halton(first, count, PIXEL_BASES, _shift(seed, 2, 2))
    return filter_offsets(uniform, kind, movement_size(kind, size_px, subpixels))


def subsample_places(counts, kind, size_px, seed=0):
    """Return the places in the pixel that subsamples look at.

    They run on from sample to sample: the subsamples of one sample, and those of all samples, are
    evenly spread over the pixel filter. They do not depend on what samples follow.

    Parameters
    ----------
    counts : ndarray of shape (N,)
        int; number of subsamples of each sample.
    kind : {'BLACKMAN_HARRIS', 'BOX'}
    size_px : float
    seed : int

    Returns
    -------
    ndarray of shape (N, K, 2)
        Offsets from the pixel's centre, in pixels, for a look-up by the nearest texel (see
        `pixel_filter.texel_offsets`).

    References
    ----------
    Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018: the sequence R2.
    """
    most = int(np.max(counts, initial=0))
    index = (np.cumsum(counts) - counts)[:, None] + np.arange(most)
    uniform = index[..., None] * np.array([1.0 / _PLASTIC, 1.0 / _PLASTIC**2])
    return texel_offsets(np.mod(uniform + _shift(seed, 2, 4), 1.0), kind, size_px)


# Side of the square of neighbouring pixels that see through sets of places of their own.
SETS = 4
# Points of a square lattice on the torus: k (1, 5) / 13, whose shortest steps are at right angles.
LATTICE_PLACES = 13
_LATTICE_STEPS = np.array([[3.0, 2.0], [-2.0, 3.0]]) / LATTICE_PLACES


def lattice_sets(iris):
    """Return sets of places on the lens for `SETS` x `SETS` neighbouring pixels.

    Each set is a lattice of its own, and all together are a finer one: they are as even as can be.

    Parameters
    ----------
    iris : Iris

    Returns
    -------
    ndarray of shape (SETS^2, LATTICE_PLACES, 2)
        In units of the aperture radius; pixel by pixel, row by row.
    """
    count = np.arange(LATTICE_PLACES)[:, None]
    lattice = count * np.array([1.0, 5.0]) / LATTICE_PLACES
    # Neighbours in the picture are far apart in the cell, or their offsets would add up with it.
    order = _dispersed(SETS).ravel()
    parts = (np.stack([order % SETS, order // SETS], axis=-1) + 0.5) / SETS
    shifts = parts @ _LATTICE_STEPS
    return iris_points(np.mod(lattice + shifts[:, None], 1.0), iris)


def _dispersed(side):
    """Return the numbers of an ordered dither, shape (side, side); a power of two."""
    order = np.zeros((1, 1), int)
    while len(order) < side:
        order = np.block([[4 * order, 4 * order + 2], [4 * order + 3, 4 * order + 1]])
    return order
