"""Where a texture, vertex colours or the material change from one triangle to its neighbour.

Such seams are lines on the surface. A place that leaves its seam would pull one side's texture
over the other's.
"""

import numpy as np

# Of all edges of a mesh: where more are seams, as with a colour a facet, none is a line.
_MOST_SHARE = 0.3


def seam_edges(mesh, surface):
    """Find the edges of which the triangles on both sides differ in more than their normals.

    Parameters
    ----------
    mesh : MeshSnapshot
    surface : Surface
        Of its places.

    Returns
    -------
    edges : ndarray of shape (E, 2)
        Places; one row for each triangle at a seam.
    owners : ndarray of shape (E,)
        Those triangles.
    """
    none = np.empty((0, 2), np.int64), np.empty(0, np.int64)
    columns = [
        np.ascontiguousarray(values[:, k], np.float32)
        for key, values in mesh.attributes.items()
        if key != "normal"
        for k in range(values.shape[1])
    ]
    split = _split(surface, columns) if len(mesh.positions) > len(surface.points) else None
    slot_of = None
    if len(mesh.slots) > 1:
        slot_of = np.repeat(np.arange(len(mesh.slots)), [count for _, _, count in mesh.slots])
        between = _between(surface, slot_of)
        split = between if split is None else split | between
    if split is None or not split.any():
        return none
    faces, vertices = surface.faces, mesh.triangles
    ends, corners, owners = [], [], []
    for k in range(3):
        j = (k + 1) % 3
        found = np.flatnonzero(split[faces[:, k]] & split[faces[:, j]])
        ends.append(faces[found][:, [k, j]])
        corners.append(vertices[found][:, [k, j]])
        owners.append(found)
    ends, corners, owners = (np.concatenate(part) for part in (ends, corners, owners))
    turned = ends[:, 0] > ends[:, 1]
    low_high = np.where(turned[:, None], ends[:, ::-1], ends).astype(np.int64)
    corners = np.where(turned[:, None], corners[:, ::-1], corners)
    keys = (low_high[:, 0] << 32) | low_high[:, 1]
    order = np.argsort(keys, kind="stable")
    first, second = order[:-1], order[1:]
    same = keys[first] == keys[second]
    first, second = first[same], second[same]
    differs = np.zeros(len(first), bool)
    if slot_of is not None:
        differs |= slot_of[owners[first]] != slot_of[owners[second]]
    for column in columns:
        differs |= (column[corners[first]] != column[corners[second]]).any(axis=1)
    found = np.concatenate([first[differs], second[differs]])
    if len(found) == 0 or len(found) > _MOST_SHARE * 3 * len(faces):
        return none
    return ends[found], owners[found]


def _split(surface, columns):
    """Return which places have vertices of different values."""
    count = len(surface.points)
    own = np.zeros(count, np.int64)
    own[surface.places[::-1]] = np.arange(len(surface.places))[::-1]
    split = np.zeros(count, bool)
    for column in columns:
        split[surface.places[column != column[own][surface.places]]] = True
    return split


def _between(surface, slot_of):
    """Return which places have triangles of several materials."""
    count = len(surface.points)
    low, high = np.full(count, slot_of.max() + 1), np.full(count, -1)
    for corner in surface.faces.T:
        np.minimum.at(low, corner, slot_of)
        np.maximum.at(high, corner, slot_of)
    return low < high
