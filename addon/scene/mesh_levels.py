"""Levels of detail of a mesh: each with about half the triangles of the one before (methods 3).

A level follows from its predecessor by merging places that edges connect. Which places merge is
decided once, by collapses of least quadric error; where they merge to, and what the vertices carry,
follows from the mesh. So a mesh that deforms without changing its topology gets its levels by
merging the same places again.

References
----------
Garland and Heckbert, *Surface simplification using quadric error metrics*, SIGGRAPH 1997; the
collapses are those of fast-simplification.
"""

from dataclasses import dataclass

import numpy as np

from .level_attributes import carry
from .level_collapses import Halving, connected, decimate, merged_places, weld
from .snapshot import MeshSnapshot, next_uid

__all__ = ["Halving", "MeshLevel", "available", "replay", "simplify", "slots_of", "surviving"]

# A level that keeps more than this share of its predecessor's triangles is not worth its memory.
_LEAST_REDUCTION = 0.75


@dataclass(frozen=True, eq=False)
class MeshLevel(MeshSnapshot):
    """A level of detail, and how the one before merged into it.

    Parameters
    ----------
    places : ndarray of shape (V,)
        int32; the place of each vertex of the level before: those of one place are the sides of a
        seam.
    merged : ndarray of shape (V,)
        int32; the vertex of this level that each of those became; -1 where nothing is left at its
        place.
    """

    places: np.ndarray | None = None
    merged: np.ndarray | None = None


def available():
    """Return whether meshes can be simplified here; some platforms lack the library."""
    try:
        import fast_simplification  # noqa: F401
    except ImportError:
        return False
    return True


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
    levels : tuple of MeshLevel
        From level 1 up; empty if the mesh cannot be simplified, or none can (see `available`).
    halvings : tuple of Halving
        One a level.
    """
    if not available():
        return (), ()
    levels, halvings = [], []
    full = len(mesh.triangles)
    places = None
    while len(mesh.triangles) >= 2 * least_triangles:
        if check is not None:
            check(full - len(mesh.triangles))
        places = weld(mesh.positions) if places is None else places
        halving = decimate(mesh, places, len(mesh.triangles) // 2)
        level, following = _merge(mesh, halving)
        if not 0 < len(level.triangles) <= _LEAST_REDUCTION * len(mesh.triangles):
            break
        levels.append(level)
        halvings.append(halving)
        mesh, places = level, following
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
    tuple of MeshLevel
    """
    levels = []
    for halving in halvings:
        mesh, _ = _merge(mesh, halving)
        levels.append(mesh)
    return tuple(levels)


def _merge(mesh, halving):
    """Return the next level, and the place of each of its vertices."""
    place = halving.groups[halving.places]
    corners = place[mesh.triangles]
    kept = surviving(halving.places[mesh.triangles], corners)
    points = merged_places(mesh, halving)
    vertex_of, vertex_places = _vertices(mesh, halving, place, kept)
    triangles = np.ascontiguousarray(vertex_of[mesh.triangles[kept]], np.int32)
    positions = np.ascontiguousarray(points[vertex_places], np.float32)
    attributes = carry(mesh, vertex_of, positions, triangles)
    # A side of a seam that has shrunk to nothing continues as another of its place.
    vertex_at = np.full(len(points), -1, np.int32)
    vertex_at[vertex_places] = np.arange(len(vertex_places), dtype=np.int32)
    level = MeshLevel(
        next_uid(),
        mesh.name,
        positions,
        triangles,
        slots_of(mesh.slots, kept),
        attributes,
        places=halving.places,
        merged=np.where(vertex_of >= 0, vertex_of, vertex_at[place]).astype(np.int32),
    )
    return level, _without_gaps(vertex_places)


def surviving(before, corners):
    """Return the triangles that stay: with three corners, and not twice.

    Where two that face each other have come to lie on one another, there is no inside left between
    them, and both go, unless they lay so already.

    Parameters
    ----------
    before, corners : ndarray of shape (T, 3)
        Places of their corners, before and after merging.

    Returns
    -------
    ndarray of shape (K,)
        Ascending numbers of triangles.
    """
    proper = _proper(corners) & _proper(before)
    kept = np.flatnonzero(proper)
    faces = corners[kept]
    order, starts = _runs(np.sort(faces, axis=1))
    if starts.all():
        return kept
    run = np.cumsum(starts) - 1
    faces, old = faces[order], np.sort(before[kept[order]], axis=1)
    a, b, c = faces.T
    # Cyclic order of the corners tells the side that a triangle faces.
    side = np.where((a < b) ^ (b < c) ^ (c < a), 1, -1)
    first = np.flatnonzero(starts)
    fresh = np.logical_or.reduceat((old != old[first[run]]).any(axis=1), first)
    balance = np.add.reduceat(side, first)
    count = np.diff(np.append(first, len(order)))
    goes = fresh & (balance == 0) & (count > 1)
    return np.sort(kept[order[first[~goes]]])


def _proper(faces):
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def _runs(rows):
    """Sort rows of three; return their order and where a row differs from the one before."""
    keys = rows.astype(np.int64)
    order = np.lexsort((keys[:, 2], (keys[:, 0] << 32) | keys[:, 1]))
    ordered = rows[order]
    starts = np.ones(len(rows), bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    return order, starts


def slots_of(slots, kept):
    """Count the kept triangles of each material slot; they are still sorted by it.

    Parameters
    ----------
    slots : tuple of (int, int, int)
        As in `MeshSnapshot`.
    kept : ndarray of shape (K,)
        Ascending numbers of triangles.

    Returns
    -------
    tuple of (int, int, int)
    """
    counts = []
    for slot, first, count in slots:
        low, high = np.searchsorted(kept, (first, first + count))
        if high > low:
            counts.append((slot, int(low), int(high - low)))
    return tuple(counts)


def _vertices(mesh, halving, place, kept):
    """Find the new vertices: one for each place and side of a seam that a kept triangle touches.

    Returns
    -------
    vertex_of : ndarray of shape (V,)
        New vertex that each old one was merged into, -1 where it is gone.
    vertex_places : ndarray of shape (W,)
        int32; the merged place of each new vertex.
    """
    # The sides of a seam stay apart, also where the seam does not cut the mesh in two.
    key = place.astype(np.int64)
    count = len(mesh.positions)
    if count > len(halving.groups):
        key = key * count + _sides(mesh.triangles, halving.places, place)
    used = np.unique(key[mesh.triangles[kept]])
    index = np.minimum(np.searchsorted(used, key), max(len(used) - 1, 0))
    found = used[index] == key if len(used) else np.zeros(count, bool)
    vertex_of = np.where(found, index, -1)
    vertex_places = np.empty(len(used), np.int32)
    vertex_places[vertex_of[found]] = place[found]
    return vertex_of, vertex_places


def _without_gaps(numbers):
    seen = np.zeros(int(numbers.max(initial=-1)) + 1, bool)
    seen[numbers] = True
    return (np.cumsum(seen, dtype=np.int32) - 1)[numbers]


def _sides(triangles, places, merged):
    """Give a number to each side of the seams at merging places: to what triangles connect there.

    Parameters
    ----------
    triangles : ndarray of shape (T, 3)
    places, merged : ndarray of shape (V,)
        Of each vertex, before and after.

    Returns
    -------
    ndarray of shape (V,)
        Equal for vertices of one side; 0 where no seam passes.
    """
    sides = np.zeros(len(places), np.int64)
    at_seam = np.zeros(int(merged.max()) + 1, bool)
    at_seam[merged[np.bincount(places)[places] > 1]] = True
    seam = at_seam[merged]
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = edges[seam[edges[:, 0]] & seam[edges[:, 1]]]
    edges = edges[merged[edges[:, 0]] == merged[edges[:, 1]]]
    number = np.cumsum(seam) - 1
    sides[seam] = connected(number[edges], int(seam.sum()))
    return sides
