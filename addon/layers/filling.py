"""Transparent pixels filled with the colours of their neighbours."""

import numpy as np


def filled(picture):
    """Return an opaque picture: colours divided by their coverage, or from around if there is none.

    Parameters
    ----------
    picture : ndarray of shape (height, width, 4)
        Scene linear, premultiplied.

    Returns
    -------
    ndarray of shape (height, width, 4)
        float32; alpha is 1. Without any coverage the picture as it is.

    References
    ----------
    Gortler, Grzeszczuk, Szeliski and Cohen, *The lumigraph*, SIGGRAPH 1996: pull and push.
    """
    levels = [np.asarray(picture, np.float32)]
    if not (levels[0][..., 3] > 0.0).any():
        return levels[0]
    while not (levels[-1][..., 3] > 0.0).all():
        levels.append(_halved(levels[-1]))
    found = _opaque(levels.pop())
    while levels:
        level = levels.pop()
        height, width = level.shape[:2]
        coarse = found.repeat(2, axis=0).repeat(2, axis=1)[:height, :width]
        found = np.where(level[..., 3:] > 0.0, _opaque(level), coarse)
    return found


def _halved(level):
    height, width = level.shape[:2]
    even = np.pad(level, ((0, height % 2), (0, width % 2), (0, 0)))
    return even.reshape(-(-height // 2), 2, -(-width // 2), 2, 4).sum(axis=(1, 3))


def _opaque(level):
    coverage = level[..., 3:]
    found = level / np.where(coverage > 0.0, coverage, 1.0)
    found[..., 3] = 1.0
    return found
