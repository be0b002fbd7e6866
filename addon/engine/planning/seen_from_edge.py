"""Bright surfaces that stay with the lens samples: the lens' middle sees them from the edge."""

import numpy as np

from ...sampling.thin_lens import projected_areas

# Least share of the area over the lens that the lens' middle has to see, for highlights to be
# searched from there: with less, discs are far from uniform, or nothing is found at all.
_LEAST_SEEN = 0.9
# Most triangles that are measured, of all surfaces and of one.
_MOST_TRIANGLES, _LEAST_TRIANGLES = 1 << 19, 1 << 8


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
