"""What shader nodes tell of a mesh's shape: pointiness, and a random number for each island."""

import numpy as np

# Jenkins, lookup3 (public domain, 2006): start of the hash of one number.
_START = np.uint32(0xDEADBEEF + (1 << 2) + 13)


def pointiness(positions, normals, edges):
    """Return how pointed a mesh is at its vertices, as Blender's Geometry node tells.

    The angle between the normal and the mean direction of the edges, over a half turn: 0.5 where
    a surface is flat, more on ridges. It is averaged with the vertices around.

    Parameters
    ----------
    positions, normals : ndarray of shape (V, 3)
        float32; unit normals.
    edges : ndarray of shape (E, 2)
        int32, vertices.

    Returns
    -------
    ndarray of shape (V,)
        float32.
    """
    # Vertices in one place count as one: seams have no edge.
    keys = np.ascontiguousarray(positions, np.float32).view(np.int32)
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    place = place.reshape(-1)
    count = len(first)
    normal = np.stack([np.bincount(place, normals[:, k], count) for k in range(3)], axis=1)
    a, b = np.unique(np.sort(place[edges], axis=1), axis=0).T
    along = (positions[first][b] - positions[first][a]).astype(np.float64)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-30)
    sums = np.stack(
        [np.bincount(a, along[:, k], count) - np.bincount(b, along[:, k], count) for k in range(3)],
        axis=1,
    )
    around = np.bincount(a, minlength=count) + np.bincount(b, minlength=count)
    length = np.linalg.norm(normal, axis=1) * np.maximum(around, 1)
    cosine = (normal * sums).sum(axis=1) / np.maximum(length, 1e-30)
    angle = np.arccos(np.clip(cosine, -1.0, 1.0)) / np.pi
    total = angle + np.bincount(a, angle[b], count) + np.bincount(b, angle[a], count)
    return (total / (around + 1))[place].astype(np.float32)


def islands(count, edges):
    """Return the lowest vertex of the island that each vertex is of, shape (V,).

    Parameters
    ----------
    count : int
        Vertices.
    edges : ndarray of shape (E, 2)
    """
    label = np.arange(count)
    a, b = edges[:, 0], edges[:, 1]
    while len(edges):
        least = np.minimum(label[a], label[b])
        before = label.copy()
        # Labels of labels: whole islands move at once.
        for side in (a, b):
            np.minimum.at(label, label[side], least)
            np.minimum.at(label, side, least)
        while not np.array_equal(label, label[label]):
            label = label[label]
        if np.array_equal(label, before):
            break
    return label


def random_numbers(numbers):
    """Return a random number from 0 to 1 of each whole number, as Blender has them.

    Parameters
    ----------
    numbers : ndarray of int

    Returns
    -------
    ndarray of float32
    """
    a = numbers.astype(np.uint32) + _START
    b = c = np.full_like(a, _START)
    for x, y, k in (("c", "b", 14), ("a", "c", 11), ("b", "a", 25)):
        a, b, c = _mixed(a, b, c, x, y, k)
    for x, y, k in (("c", "b", 16), ("a", "c", 4), ("b", "a", 14), ("c", "b", 24)):
        a, b, c = _mixed(a, b, c, x, y, k)
    return (c.astype(np.float64) / 0xFFFFFFFF).astype(np.float32)


def _mixed(a, b, c, target, other, turn):
    """Return the three parts with one of them mixed with another, turned by some bits."""
    parts = {"a": a, "b": b, "c": c}
    y = parts[other]
    turned = (y << np.uint32(turn)) | (y >> np.uint32(32 - turn))
    parts[target] = (parts[target] ^ y) - turned
    return parts["a"], parts["b"], parts["c"]
