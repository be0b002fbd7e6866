"""Areas of triangles in pictures from the places on the lens (methods 1).

Seen from a place `v` on the lens, a point at depth `d` appears at ``p - v k``, with ``p`` where the
pinhole shows it and ``k = 1/d - 1/f`` (with a parallel projection ``1 - d/f``), `f` the focus
distance. The signed area of a triangle is therefore ``a + g . v``: it changes linearly over the
lens, and its mean over the lens is the area from the middle, unless the plane of the triangle cuts
the lens. Such a triangle is seen from the edge, and from both its sides.
"""

import numpy as np

# Least share of the area over the lens that the lens' middle has to see, for highlights to be
# searched from there: with less, discs are far from uniform, or nothing is found at all.
_LEAST_SEEN = 0.9
# Most triangles that are measured, of all surfaces and of one.
_MOST_TRIANGLES, _LEAST_TRIANGLES = 1 << 19, 1 << 8


def projected_areas(corners, focus_distance, extent, orthographic=False):
    """Return the areas of triangles from the lens' middle, and their mean over the lens.

    Parameters
    ----------
    corners : ndarray of shape (..., 3, 3)
        The three corners, in camera space, m; in front of the lens.
    focus_distance : float
        In m.
    extent : sequence of 2 float
        Half the width and height of the opening, an ellipse, m.
    orthographic : bool
        A parallel projection.

    Returns
    -------
    middle, mean : ndarray of shape (...)
        On a plane at unit distance, or across the projection, in m^2; front and back facing alike.
    """
    depth = -corners[..., 2:]
    if orthographic:
        place, moves = corners[..., :2], 1.0 - depth / focus_distance
    else:
        place, moves = corners[..., :2] / depth, 1.0 / depth - 1.0 / focus_distance
    u, w = (place[..., i, :] - place[..., 0, :] for i in (1, 2))
    alpha, beta = (moves[..., i, :] - moves[..., 0, :] for i in (1, 2))
    middle = 0.5 * np.abs(u[..., 0] * w[..., 1] - u[..., 1] * w[..., 0])
    turned = 0.5 * (beta * u - alpha * w)
    # Largest change over the lens.
    change = np.hypot(turned[..., 1] * extent[0], turned[..., 0] * extent[1])
    cut = middle < change
    share = np.where(cut, middle, 0.0) / np.maximum(change, 1e-300)
    return middle, np.where(cut, change * _mean_distance(share), middle)


def seen_from_edge(content, surfaces, plan):
    """Return the surfaces that the lens' middle sees much less of than the whole lens.

    Parameters
    ----------
    content : SceneContent
    surfaces : iterable of (int, int)
        Group and slot.
    plan : FramePlan

    Returns
    -------
    frozenset of (int, int)
        All instances of a group count together; of many triangles some are measured.
    """
    surfaces = sorted(surfaces)
    budget = max(_LEAST_TRIANGLES, _MOST_TRIANGLES // max(len(surfaces), 1))
    return frozenset(key for key in surfaces if _is_seen_from_edge(content, key, plan, budget))


def _is_seen_from_edge(content, key, plan, budget):
    group = content.groups[key[0]]
    mesh = content.meshes[group.mesh]
    parts = [mesh.triangles[first : first + n] for slot, first, n in mesh.slots if slot == key[1]]
    triangles = np.concatenate([np.zeros((0, 3), int), *parts])
    triangles = triangles[:: max(1, -(-len(triangles) // budget))]
    rows = np.arange(group.first, group.first + group.count)
    rows = rows[:: max(1, -(-len(rows) * len(triangles) // budget))]
    to_eye = (plan.view @ content.instances.world[rows])[:, :3]
    corners = mesh.positions[triangles] @ to_eye[:, None, :, :3].swapaxes(-1, -2)
    corners = corners + to_eye[:, None, None, :, 3]
    corners = corners[(corners[..., 2] < 0.0).all(axis=-1)]
    areas = projected_areas(corners, plan.focus_distance, plan.lens_extent, plan.orthographic)
    middle, mean = (area.sum() for area in areas)
    return bool(middle < _LEAST_SEEN * mean)


def _mean_distance(c):
    """Return the mean of ``|c + x|`` over a unit disk, for c from 0 to 1."""
    root = np.sqrt(1.0 - c**2)
    return 2.0 / np.pi * (c * np.arcsin(c) + root * (c**2 + 2.0) / 3.0)
