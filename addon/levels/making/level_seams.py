"""Seams: edges across which UVs, vertex colours or the material are discontinuous.

Seams are lines on the surface. A place that leaves its seam would pull the texture of one side over
the other. Seams of further levels follow from the places that merge, so that meshes of one shape
with the same seams merge alike, whatever their attributes are.
"""

import numpy as np

# Largest share of a mesh' edges in seams: where there are more, as with a colour for each facet,
# they are not treated as seams.
_MOST_SHARE = 0.3


def seam_edges(mesh, places):
    """Find the edges whose two triangles differ in more than their normals.

    Parameters
    ----------
    mesh : MeshSnapshot
    places : ndarray of shape (V,)
        Of its vertices.

    Returns
    -------
    ndarray of shape (E, 2)
        int32; pairs of places, each once and sorted.
    """
    none = np.empty((0, 2), np.int32)
    count = int(places.max(initial=-1)) + 1
    faces, vertices = places[mesh.triangles], mesh.triangles
    columns = [
        np.ascontiguousarray(values[:, k], np.float32)
        for key, values in mesh.attributes.items()
        if key != "normal"
        for k in range(values.shape[1])
    ]
    split = _split(places, columns, count) if len(places) > count else None
    slot_of = None
    if len(mesh.slots) > 1:
        slot_of = np.repeat(np.arange(len(mesh.slots)), [count for _, _, count in mesh.slots])
        between = _between(faces, slot_of, count)
        split = between if split is None else split | between
    if split is None or not split.any():
        return none
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
    found = np.unique(keys[first[differs]])
    if len(found) == 0 or len(found) > _MOST_SHARE * 1.5 * len(faces):
        return none
    return _pairs(found)


def materials_meet(mesh, places):
    """Whether any edge lies between triangles of two materials.

    Parameters
    ----------
    mesh : MeshSnapshot
    places : ndarray of shape (V,)
        Of its vertices.

    Returns
    -------
    bool
    """
    if len(mesh.slots) < 2:
        return False
    slot_of = np.repeat(np.arange(len(mesh.slots)), [count for _, _, count in mesh.slots])
    faces = places[mesh.triangles]
    ends = np.sort(np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    keys = (ends[:, 0].astype(np.int64) << 32) | ends[:, 1]
    order = np.argsort(keys, kind="stable")
    same = keys[order[:-1]] == keys[order[1:]]
    slots = np.tile(slot_of, 3)[order]
    return bool((same & (slots[:-1] != slots[1:])).any())


def following_seams(seams, number):
    """Return the seams of the next level.

    Parameters
    ----------
    seams : ndarray of shape (E, 2)
    number : ndarray of shape (P,)
        The place that each place becomes, -1 where nothing is left.

    Returns
    -------
    ndarray of shape (F, 2)
        int32.
    """
    ends = np.sort(number[seams], axis=1).astype(np.int64)
    ends = ends[(ends[:, 0] >= 0) & (ends[:, 0] != ends[:, 1])]
    return _pairs(np.unique((ends[:, 0] << 32) | ends[:, 1]))


def _pairs(keys):
    return np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1).astype(np.int32)


def _split(places, columns, count):
    """Return which places have vertices of different values."""
    own = np.zeros(count, np.int64)
    own[places[::-1]] = np.arange(len(places))[::-1]
    split = np.zeros(count, bool)
    for column in columns:
        split[places[column != column[own][places]]] = True
    return split


def _between(faces, slot_of, count):
    """Return which places have triangles of several materials."""
    low, high = np.full(count, slot_of.max() + 1), np.full(count, -1)
    for corner in faces.T:
        np.minimum.at(low, corner, slot_of)
        np.maximum.at(high, corner, slot_of)
    return low < high
