"""The Halton sequence.

Element `i` in base `b` is the radical inverse of `i`: its base-`b` digits mirrored at the point.
Any contiguous run of the sequence is itself nearly uniform, which progressive refinement and the
blending of levels of detail rely on (methods 2).
"""

import numpy as np


def radical_inverse(index, base):
    """Mirror the digits of integers at the radix point.

    Parameters
    ----------
    index : array_like of int, shape (...)
        Non-negative.
    base : int
        At least 2.

    Returns
    -------
    ndarray of shape (...)
        float64 in [0, 1).

    References
    ----------
    Halton, Numerische Mathematik 2, 1960.
    """
    index = np.array(index, dtype=np.int64)
    result = np.zeros(index.shape)
    scale = 1.0 / base
    while np.any(index):
        index, digit = np.divmod(index, base)
        result += digit * scale
        scale /= base
    return result


def halton(first, count, bases, shift=0.0):
    """Return a run of the Halton sequence, one dimension a base, shifted on the torus.

    Parameters
    ----------
    first, count : int
        The run holds elements `first` to `first + count - 1`.
    bases : sequence of int
        Pairwise coprime.
    shift : float or array_like of shape (len(bases),)
        Added to every element modulo 1 (Cranley-Patterson rotation).

    Returns
    -------
    ndarray of shape (count, len(bases))
        float64 in [0, 1).
    """
    index = np.arange(first, first + count, dtype=np.int64)
    points = np.stack([radical_inverse(index, base) for base in bases], axis=-1)
    return np.mod(points + shift, 1.0)
