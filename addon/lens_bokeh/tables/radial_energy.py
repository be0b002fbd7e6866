"""Energy of a fan of rays in rings round the axis, exact for piecewise linear fans.

Rays from the axis to the rim of the pupil cross a plane at signed heights; between two neighbours
lies the energy of their annulus of the pupil, ``pi (g_2^2 - g_1^2)``. Between them, height and g
are taken as linear in each other. Where the heights turn (a fold: a caustic) the fan is cut into
branches; on each one the energy up to a height is known, and a ring takes the difference. So no
energy is lost or made, and there is no noise of sampling.
"""

import numpy as np


def ring_energy(heights, energy_radii, edges):
    """Energy that a fan of rays leaves in each ring.

    Parameters
    ----------
    heights : ndarray of shape (n,)
        Signed, from the axial ray outwards; the fan is symmetric about the axis.
    energy_radii : ndarray of shape (n,)
        g of each ray, rising.
    edges : ndarray of shape (rings + 1,)
        Radii, rising from 0. Energy beyond the last one is counted in the last ring.

    Returns
    -------
    ndarray of shape (rings,)
        Their sum is ``pi (g_last^2 - g_first^2)``.
    """
    rings = len(edges) - 1
    limits = np.array(edges, dtype=np.float64)
    # All that lies beyond the edge falls into the last ring.
    limits[-1] = np.inf
    total = np.zeros(rings)
    for start, end in _branches(heights):
        h, g = heights[start : end + 1], energy_radii[start : end + 1]
        if h[-1] < h[0]:
            h, g = h[::-1], g[::-1]
        if h[0] < 0.0 < h[-1]:
            signed = np.concatenate([-limits[:0:-1], limits])
            part = np.abs(np.diff(np.interp(signed, h, g) ** 2))
            total += part[rings:] + part[:rings][::-1]
        elif h[-1] <= 0.0:
            total += _on_one_side(-h[::-1], g[::-1], limits)
        else:
            total += _on_one_side(h, g, limits)
    return np.pi * total


def _on_one_side(h, g, limits):
    inner = np.interp(limits[1:-1], h, g)
    steps = np.concatenate([g[:1], inner, g[-1:]])
    return np.abs(np.diff(steps * steps))


def _branches(heights):
    """First and last ray of each stretch on which the height only rises or only falls."""
    steps = np.sign(np.diff(heights))
    moving = np.flatnonzero(steps)
    if len(moving) == 0:
        return [(0, len(heights) - 1)]
    turns = moving[1:][np.diff(steps[moving]) != 0.0]
    bounds = [0, *turns.tolist(), len(heights) - 1]
    return list(zip(bounds[:-1], bounds[1:], strict=True))
