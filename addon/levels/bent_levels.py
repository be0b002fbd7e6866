"""Levels of detail that keep the distribution of what a material bends into light.

A level keeps the mean of every attribute, and less of its variation. Where a material turns an
attribute into light by a function that is not linear (`bent_attributes`), that changes
the mean of the light, and no blur hides it: slopes of a terrain that are just steep enough for
rock lie in fewer and fewer triangles. Let two distributions differ by at most `D`, in the share of
the surface with at most a value. The means of any function of that value then differ by at most
`D` times the way that the function goes up and down (integrate by parts). So `D` alone bounds the
error of the light, whatever the material makes of the attribute.
"""

import numpy as np

# Largest difference of the distributions. Light may differ by as much; as for the shares of the
# materials, see `making.mesh_levels`.
_MOST_SHIFT = 0.003
# Values of an attribute that are told apart, of its range: far finer than ramps, coarser than
# rounding.
_BINS = 16384


def unbent_levels(mesh, levels, keys):
    """Return how many levels of a mesh keep the distributions of some attributes.

    Parameters
    ----------
    mesh : MeshSnapshot
        Full detail.
    levels : sequence of MeshLevel
        From level 1 up.
    keys : iterable of str
        Of the attributes; those that the mesh lacks do not count.

    Returns
    -------
    int
        All coarser levels are further from full detail.
    """
    kept = len(levels)
    for key in sorted(keys & mesh.attributes.keys()):
        values = mesh.attributes[key][:, :3]
        ends = np.stack([values.min(axis=0), values.max(axis=0)]).astype(np.float64)
        if key == "normal":
            ends = np.array([[-1.0] * 3, [1.0] * 3])
        right = _shares(mesh, key, ends)
        for number, level in enumerate(levels[:kept]):
            if _largest_shift(right, _shares(level, key, ends)) > _MOST_SHIFT:
                kept = number
                break
    return kept


def _shares(mesh, key, ends):
    """Return the share of the surface with at most a value, by component and bin."""
    points = mesh.positions[mesh.triangles].astype(np.float64)
    across = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    area = np.tile(np.linalg.norm(across, axis=1), 3)
    corners = mesh.attributes[key][:, :3].astype(np.float64)[mesh.triangles]
    # Middles of edges stand for a third of the triangle each: exact for squares of what varies
    # linearly over it.
    middles = np.concatenate([corners[:, i] + corners[:, i - 1] for i in range(3)]) / 2.0
    if key == "normal":
        # As surfaces are drawn.
        middles /= np.maximum(np.linalg.norm(middles, axis=1, keepdims=True), 1e-30)
    low, high = ends
    place = (middles - low) / np.maximum(high - low, 1e-30) * (_BINS - 1) + 0.5
    place = np.clip(place, 0.0, _BINS - 1.0).astype(np.int32)
    found = [np.cumsum(np.bincount(column, area, _BINS)) for column in place.T]
    return np.stack(found) / max(float(area.sum()), 1e-300)


def _largest_shift(right, found):
    """Return the largest difference of shares, but for what a shift by one bin explains."""
    above = right[:, :-1] - found[:, 1:]
    below = found[:, :-1] - right[:, 1:]
    return float(max(above.max(initial=0.0), below.max(initial=0.0)))
