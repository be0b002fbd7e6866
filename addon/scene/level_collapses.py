"""Which places of a mesh merge into one in the next level of detail, and where they merge to.

fast-simplification decides the collapses. It never moves a border's vertex inwards, so a mesh of
many holes would stay as it is: holes are closed by cones for it, whose steep sides hold the border
as Garland's perpendicular planes do, while a small hole may vanish.

A group of places merges where the sum of its squared distances from the planes of the triangles
round it, weighted by their area, is least.
"""

import threading
from dataclasses import dataclass

import numpy as np

# fast-simplification's thresholds begin at 2e-6 in squared lengths: the mesh is scaled so that its
# edges are long against that, and the best collapses come first.
_EDGE_LENGTH = 0.5
# Of a triangle that takes part, in mean areas.
_LEAST_AREA = 1e-9
# Height of the cone over a hole, in radii of the hole.
_CONE_HEIGHT = 3.0
# Weight of a border's perpendicular plane against the triangle at the border.
_BORDER_WEIGHT = 10.0
# How much of the quadric's trace, without borders, pulls a merged place to the mean of its group.
_PULL = 0.1

# The library keeps its mesh in global variables.
_library = threading.Lock()


@dataclass(frozen=True, eq=False)
class Halving:
    """How one level follows from the one before.

    Parameters
    ----------
    places : ndarray of shape (V,)
        int32; the place of each vertex: those of one place are the sides of a seam.
    groups : ndarray of shape (P,)
        int32; the place that each place merges into, in the next level.
    """

    places: np.ndarray
    groups: np.ndarray


def weld(positions):
    """Give a number to each distinct position, bit by bit, in the order of their first vertices.

    Parameters
    ----------
    positions : ndarray of shape (V, 3)

    Returns
    -------
    ndarray of shape (V,)
        int32.
    """
    # 0.0 and -0.0 are one place.
    bits = (np.ascontiguousarray(positions, np.float32) + np.float32(0.0)).view(np.uint32)
    columns = bits.T.astype(np.uint64)
    order = np.lexsort((columns[2], (columns[0] << np.uint64(32)) | columns[1]))
    ordered = bits[order]
    starts = np.ones(len(bits), bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    run = np.cumsum(starts) - 1
    # The sort is stable, so a run's first is its least vertex.
    first = order[starts]
    rank = np.empty(len(first), np.int32)
    rank[np.argsort(first, kind="stable")] = np.arange(len(first), dtype=np.int32)
    result = np.empty(len(bits), np.int32)
    result[order] = rank[run]
    return result


def decimate(mesh, places, triangles):
    """Decide which places merge.

    Parameters
    ----------
    mesh : MeshSnapshot
    places : ndarray of shape (V,)
        Of its vertices.
    triangles : int
        How many to leave.

    Returns
    -------
    Halving
    """
    import fast_simplification

    points = _points(mesh.positions, places).astype(np.float64)
    faces = places[mesh.triangles]
    a, b, c = faces.T
    across = np.cross(points[b] - points[a], points[c] - points[a])
    size = np.linalg.norm(across, axis=1)
    # A triangle without area has no plane, and none of its errors would be a number.
    faces = np.ascontiguousarray(faces[size > _LEAST_AREA * size.mean()])
    groups = np.arange(len(points), dtype=np.int32)
    if len(faces) == 0:
        return Halving(places, groups)
    edge = np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1).mean()
    scaled = (points - points.mean(axis=0)) * (_EDGE_LENGTH / max(edge, 1e-30))
    apexes, cones = _cones(scaled, faces)
    with _library:
        _, _, collapses = fast_simplification.simplify(
            np.concatenate([scaled, apexes]),
            _shuffled(np.concatenate([faces, cones])),
            target_count=min(triangles + len(cones) // 2, len(faces) + len(cones)),
            return_collapses=True,
        )
    return Halving(places, _groups(np.asarray(collapses).reshape(-1, 2), len(points), len(apexes)))


def _shuffled(faces):
    """Return faces in an order without meaning: the library stops in the midst of a round."""
    order = np.random.default_rng(0).permutation(len(faces))
    return np.ascontiguousarray(faces[order], np.int32)


def _points(positions, places):
    points = np.empty((int(places.max(initial=-1)) + 1, 3), np.float32)
    points[places[::-1]] = positions[::-1]
    return points


def _groups(collapses, count, apexes):
    """Follow the collapses: each moves its second place into its first."""
    target = np.arange(count + apexes)
    target[collapses[:, 1]] = collapses[:, 0]
    while True:
        following = target[target]
        if np.array_equal(following, target):
            break
        target = following
    # Numbered by the first place of each group, which is no apex.
    _, first, inverse = np.unique(target[:count], return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int32)
    rank[np.argsort(first, kind="stable")] = np.arange(len(first), dtype=np.int32)
    return rank[inverse.ravel()]


def _borders(faces):
    """Return the edges that one triangle has alone, shape (E, 2), and those triangles."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    low, high = edges.min(axis=1).astype(np.int64), edges.max(axis=1)
    keys = (low << 32) | high
    order = np.argsort(keys, kind="stable")
    ordered = keys[order]
    differs = ordered[1:] != ordered[:-1]
    alone = np.ones(len(keys), bool)
    alone[1:] &= differs
    alone[:-1] &= differs
    single = np.sort(order[alone])
    return edges[single], single % len(faces)


def _cones(points, faces):
    """Return apexes over the holes, shape (K, 3), and triangles from the borders to them."""
    border, owner = _borders(faces)
    if len(border) == 0:
        return np.empty((0, 3)), np.empty((0, 3), np.int32)
    used, local = np.unique(border, return_inverse=True)
    local = local.reshape(border.shape)
    hole = connected(local, len(used))
    numbers, hole = np.unique(hole, return_inverse=True)
    count = len(numbers)

    def mean(values, index):
        total = np.stack([np.bincount(index, v, count) for v in values.T], axis=1)
        return total / np.bincount(index, minlength=count)[:, None]

    center = mean(points[used], hole)
    radius = np.sqrt(mean(np.square(points[used] - center[hole]).sum(axis=1)[:, None], hole))
    a, b, c = (points[corner] for corner in faces[owner].T)
    normal = mean(np.cross(b - a, c - a), hole[local[:, 0]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    apexes = center + _CONE_HEIGHT * radius * normal
    cones = np.column_stack([border[:, 1], border[:, 0], len(points) + hole[local[:, 0]]])
    return apexes, cones


def connected(edges, count):
    """Give a number to each part that edges connect.

    Parameters
    ----------
    edges : ndarray of shape (E, 2)
    count : int
        Of the nodes.

    Returns
    -------
    ndarray of shape (count,)
        The least node of each one's part.
    """
    label = np.arange(count)
    while True:
        least = np.minimum(label[edges[:, 0]], label[edges[:, 1]])
        following = label.copy()
        # The roots are joined, too, so that the number of rounds grows with the logarithm.
        for end in edges.T:
            np.minimum.at(following, end, least)
            np.minimum.at(following, label[end], least)
        following = following[following]
        if np.array_equal(following, label):
            return label
        label = following


def merged_places(mesh, halving):
    """Return where the groups of places merge to.

    Parameters
    ----------
    mesh : MeshSnapshot
    halving : Halving

    Returns
    -------
    ndarray of shape (G, 3)
    """
    points = _points(mesh.positions, halving.places).astype(np.float64)
    groups = halving.groups
    count = int(groups.max(initial=-1)) + 1
    faces = halving.places[mesh.triangles]
    sizes = np.bincount(groups, minlength=count)
    mean = np.stack([np.bincount(groups, v, count) for v in points.T], axis=1)
    mean /= np.maximum(sizes, 1)[:, None]
    a, b, c = (points[corner] for corner in faces.T)
    across = np.cross(b - a, c - a)
    length = np.linalg.norm(across, axis=1)
    normal = across / np.maximum(length, 1e-300)[:, None]
    quadric = np.zeros((count, 3, 3))
    pull = np.zeros((count, 3))
    moving = sizes > 1
    _add_planes(quadric, pull, mean, groups[faces], a, normal, length, moving)
    trace = np.trace(quadric, axis1=1, axis2=2)
    strength = np.where(trace > 0.0, _PULL * trace, 1.0)
    quadric += strength[:, None, None] * np.eye(3)
    border, owner = _borders(faces)
    if len(border):
        start, end = points[border[:, 0]], points[border[:, 1]]
        outward = np.cross(end - start, normal[owner])
        strength = np.linalg.norm(outward, axis=1)
        outward /= np.maximum(strength, 1e-300)[:, None]
        weight = _BORDER_WEIGHT * strength**2
        _add_planes(quadric, pull, mean, groups[border], start, outward, weight, moving)
    move = np.linalg.solve(quadric, pull[:, :, None])[:, :, 0]
    return mean + move


def _add_planes(quadric, pull, mean, corners, through, normal, weight, moving):
    """Add the squared distances from planes, seen from each group's mean, once a group."""
    for k in range(corners.shape[1]):
        group = corners[:, k]
        # A plane counts once for a group, however many of its corners are in it.
        once = moving[group].copy()
        for j in range(k):
            once &= corners[:, j] != group
        group, n, w = group[once], normal[once], weight[once]
        distance = (n * (through[once] - mean[group])).sum(axis=1)
        for i in range(3):
            pull[:, i] += np.bincount(group, w * n[:, i] * distance, len(mean))
            for j in range(i, 3):
                quadric[:, i, j] += np.bincount(group, w * n[:, i] * n[:, j], len(mean))
    for i, j in ((0, 1), (0, 2), (1, 2)):
        quadric[:, j, i] = quadric[:, i, j]
