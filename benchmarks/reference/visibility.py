"""What hides a point from places on the lens, ray by ray: the twin of the masks of highlights.

A ray runs from the highlight to a place on the lens; what it meets between the clip start and the
highlight's own surface hides it. For a parallel camera a place on the lens is a direction, see
`lib/bokeh/visibility_lib.glsl`.
"""

import numpy as np


def lens_places(side):
    """Return the places of a mask's texels in units of half the opening, shape (side, side, 2)."""
    axis = (np.arange(side) + 0.5) / side * 2.0 - 1.0
    x, y = np.meshgrid(axis, axis)
    return np.stack([x, y], axis=-1)


def ray_end(source, lens, focus=None):
    """Return where rays from a source meet the plane of the lens.

    Parameters
    ----------
    source : array_like of shape (3,)
        x, y and depth in camera space, m.
    lens : ndarray of shape (..., 2)
        Places on the lens, m.
    focus : float, optional
        Focus distance of a parallel camera.

    Returns
    -------
    ndarray of shape (..., 3)
        x, y and depth.
    """
    source = np.asarray(source, float)
    end = np.zeros((*lens.shape[:-1], 3))
    end[..., :2] = lens if focus is None else source[:2] + lens * (source[2] / focus)
    return end


def seen(source, triangles, lens, start, hides, focus=None):
    """Return whether a source is seen from places on the lens.

    Parameters
    ----------
    source : array_like of shape (3,)
        x, y and depth in camera space, m.
    triangles : ndarray of shape (T, 3, 3)
        x, y and depth of their corners in camera space, m.
    lens : ndarray of shape (..., 2)
        Places on the lens, m.
    start, hides : float
        Depths between which surfaces hide the source, m.
    focus : float, optional
        Focus distance of a parallel camera.

    Returns
    -------
    ndarray of shape (...)
        bool.

    References
    ----------
    Moeller and Trumbore, *Fast, minimum storage ray-triangle intersection*, JGT 2(1), 1997.
    """
    source = np.asarray(source, float)
    way = ray_end(source, lens, focus) - source
    free = np.ones(way.shape[:-1], bool)
    for a, b, c in np.asarray(triangles, float):
        e1, e2 = b - a, c - a
        p = np.cross(way, e2)
        determinant = p @ e1
        scale = np.where(determinant == 0.0, 1.0, determinant)
        t = source - a
        u = (p @ t) / scale
        q = np.cross(t, e1)
        v = (way @ q) / scale
        depth = source[2] + (e2 @ q) / scale * way[..., 2]
        free &= ~(
            (determinant != 0.0)
            & (u >= 0.0)
            & (v >= 0.0)
            & (u + v <= 1.0)
            & (depth >= start)
            & (depth <= hides)
        )
    return free
