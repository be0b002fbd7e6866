"""Levels of detail of a mesh: each with about half the triangles of the one before (methods 3).

A level is made from its predecessor by edge collapses. The sequence of collapses is kept, so that a
mesh that deforms without changing its topology gets its levels by replaying it on the new
positions. What a vertex carries follows. Colours and normals are averaged over the old vertices that
were collapsed into a new one on the same side of every seam, by the area each stood for, so that the
light of a blurred surface stays the same; UVs are those of the nearest of them, since a mean of
places in a texture need not lie near any.

References
----------
Garland and Heckbert, *Surface simplification using quadric error metrics*, SIGGRAPH 1997, as
implemented by fast-simplification.
"""

from dataclasses import dataclass

import numpy as np

from .snapshot import MeshSnapshot, next_uid

# A level that keeps more than this share of its predecessor's triangles is not worth its memory.
_LEAST_REDUCTION = 0.75


@dataclass(frozen=True, eq=False)
class Halving:
    """How one level follows from the one before.

    Parameters
    ----------
    weld : ndarray of shape (V,)
        int32; the place of each vertex: those of one place are the sides of a seam.
    collapses : ndarray of shape (C, 2)
        int32; pairs of places, the second moves into the first, in order.
    """

    weld: np.ndarray
    collapses: np.ndarray


def simplify(mesh, least_triangles, check=None):
    """Make the levels of a mesh.

    Parameters
    ----------
    mesh : MeshSnapshot
    least_triangles : int
        No level has fewer, unless the mesh itself has.
    check : callable, optional
        Called before each level with the triangles that the mesh has lost so far; it may raise to
        end the work.

    Returns
    -------
    levels : tuple of MeshSnapshot
        From level 1 up; empty if the mesh cannot be simplified.
    halvings : tuple of Halving
        One a level.
    """
    levels, halvings = [], []
    full = len(mesh.triangles)
    while len(mesh.triangles) >= 2 * least_triangles:
        if check is not None:
            check(full - len(mesh.triangles))
        halving = _decimate(mesh, len(mesh.triangles) // 2)
        level = _replay(mesh, halving)
        if len(level.triangles) > _LEAST_REDUCTION * len(mesh.triangles):
            break
        levels.append(level)
        halvings.append(halving)
        mesh = level
    return tuple(levels), tuple(halvings)


def replay(mesh, halvings):
    """Make the levels of a mesh of the same topology by the same collapses.

    Parameters
    ----------
    mesh : MeshSnapshot
        With the triangles of the mesh that was simplified; its positions may differ.
    halvings : sequence of Halving

    Returns
    -------
    tuple of MeshSnapshot
    """
    levels = []
    for halving in halvings:
        mesh = _replay(mesh, halving)
        levels.append(mesh)
    return tuple(levels)


def _decimate(mesh, triangles):
    import fast_simplification

    weld = _weld(mesh.positions)
    places = _places(mesh.positions, weld)
    faces = _faces(mesh, weld)
    _, _, collapses = fast_simplification.simplify(
        places, faces, target_count=triangles, return_collapses=True
    )
    return Halving(weld, np.ascontiguousarray(collapses, np.int32))


def _weld(positions):
    """Number the distinct positions, equal bit by bit, in the order of their first vertices."""
    rows = np.ascontiguousarray(positions, np.float32)
    # 0.0 and -0.0 are one place.
    bits = (rows + np.float32(0.0)).view(np.dtype((np.void, 12))).ravel()
    _, first, inverse = np.unique(bits, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int32)
    rank[np.argsort(first, kind="stable")] = np.arange(len(first), dtype=np.int32)
    return rank[inverse.ravel()]


def _places(positions, weld):
    places = np.empty((int(weld.max(initial=-1)) + 1, 3), np.float32)
    places[weld[::-1]] = positions[::-1]
    return places


def _faces(mesh, weld):
    return np.ascontiguousarray(weld[mesh.triangles], np.int32)


def _replay(mesh, halving):
    import fast_simplification

    weld = halving.weld
    places = _places(mesh.positions, weld)
    faces = _faces(mesh, weld)
    # What has no area already would be taken for an edge.
    proper = _proper(faces)
    points, _, moved = fast_simplification.replay_simplification(
        places, np.ascontiguousarray(faces[proper]), halving.collapses
    )
    target = np.asarray(moved, np.int64)[faces]
    kept = np.flatnonzero(proper & _proper(target) & (target >= 0).all(axis=1))
    kept = kept[_first_of_equal(target[kept])]
    vertices, vertex_of, triangles = _vertices(
        mesh, weld, np.asarray(moved, np.int64), kept, points
    )
    positions = np.ascontiguousarray(points[vertices], np.float32)
    attributes = {
        key: _carry(key, values, mesh, vertex_of, positions, triangles)
        for key, values in mesh.attributes.items()
    }
    return MeshSnapshot(
        next_uid(), mesh.name, positions, triangles, _slots(mesh.slots, kept), attributes
    )


def _proper(faces):
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def _first_of_equal(faces):
    """Return which faces to keep: of those with the same corners, the first."""
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return np.sort(first)


def _slots(slots, kept):
    """Count the kept triangles of each material slot; they are still sorted by it."""
    counts = []
    for slot, first, count in slots:
        low, high = np.searchsorted(kept, (first, first + count))
        if high > low:
            counts.append((slot, int(low), int(high - low)))
    return tuple(counts)


def _vertices(mesh, weld, moved, kept, points):
    """Find the new vertices: one for each place and side of a seam that a kept triangle touches.

    Returns
    -------
    vertices : ndarray of shape (W,)
        Index into `points`.
    vertex_of : ndarray of shape (V,)
        New vertex that each old one was collapsed into, -1 where it is gone.
    triangles : ndarray of shape (T, 3)
        int32, of new vertices.
    """
    place = moved[weld]
    if len(mesh.positions) == len(moved):
        key = place
    else:
        sides = _sides(mesh.triangles, len(mesh.positions))
        key = np.where(place >= 0, place * len(mesh.positions) + sides, -1)
    used = np.unique(key[mesh.triangles[kept]])
    index = np.clip(np.searchsorted(used, key), 0, max(len(used) - 1, 0))
    found = used[index] == key if len(used) else np.zeros(len(key), bool)
    vertex_of = np.where(found & (place >= 0), index, -1)
    triangles = np.ascontiguousarray(vertex_of[mesh.triangles[kept]], np.int32)
    vertices = np.empty(len(used), np.int64)
    vertices[vertex_of[vertex_of >= 0]] = place[vertex_of >= 0]
    return vertices, vertex_of, triangles


def _sides(triangles, count):
    """Number the parts into which seams cut a mesh: vertices that triangles connect."""
    sides = np.arange(count)
    edges = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    while True:
        least = np.minimum(sides[edges[:, 0]], sides[edges[:, 1]])
        following = sides.copy()
        # The roots are joined, too, so that the number of rounds grows with the logarithm.
        for corner in edges.T:
            np.minimum.at(following, corner, least)
            np.minimum.at(following, sides[corner], least)
        following = following[following]
        if np.array_equal(following, sides):
            return sides
        sides = following


def _carry(key, values, mesh, vertex_of, positions, triangles):
    if key.startswith("uv:"):
        return np.ascontiguousarray(values[_nearest(mesh.positions, vertex_of, positions)])
    total = _mean(values, mesh, vertex_of, len(positions))
    if key == "normal":
        total = _upright_facets(total, positions, triangles)
        total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-30)
    return np.ascontiguousarray(total, np.float32)


def _nearest(old, vertex_of, new):
    """Return, for each new vertex, the nearest of the old ones that were collapsed into it."""
    members = np.flatnonzero(vertex_of >= 0)
    owner = vertex_of[members]
    distance = np.square(old[members] - new[owner]).sum(axis=1)
    order = np.lexsort((distance, owner))
    first = np.searchsorted(owner[order], np.arange(len(new)))
    return members[order[first]]


def _mean(values, mesh, vertex_of, count):
    """Average values over each new vertex, by the area that its old ones stood for."""
    members = np.flatnonzero(vertex_of >= 0)
    owner = vertex_of[members]
    area = _vertex_areas(mesh)[members]
    columns = [
        np.bincount(owner, weights=area * values[members, k], minlength=count)
        for k in range(values.shape[1])
    ]
    weight = np.bincount(owner, weights=area, minlength=count)
    return np.stack(columns, axis=1) / np.maximum(weight, 1e-300)[:, None]


def _vertex_areas(mesh):
    """Return a third of the area of the triangles round each vertex, never quite 0."""
    across = np.linalg.norm(_facets(mesh.positions, mesh.triangles), axis=1)
    areas = np.zeros(len(mesh.positions))
    for corner in mesh.triangles.T:
        areas += np.bincount(corner, weights=across / 6.0, minlength=len(areas))
    return areas + max(float(areas.mean()) if len(areas) else 0.0, 1e-30) * 1e-6


def _facets(positions, triangles):
    """Return the triangles' normals, twice their area long."""
    a, b, c = (positions[corner].astype(np.float64) for corner in triangles.T)
    return np.cross(b - a, c - a)


def _upright_facets(normals, positions, triangles):
    """Give a vertex of one triangle only, a flat facet's, that facet's own normal."""
    uses = np.bincount(triangles.ravel(), minlength=len(positions))
    across = _facets(positions, triangles)
    facet = np.zeros((len(positions), 3))
    for corner in triangles.T:
        facet[corner] = across
    alone = (uses == 1) | (np.linalg.norm(normals, axis=1) < 1e-6)
    facing = np.where((facet * normals).sum(axis=1, keepdims=True) < 0.0, -facet, facet)
    return np.where(alone[:, None], facing, normals)
