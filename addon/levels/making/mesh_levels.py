"""Levels of detail of a mesh: each with about half the triangles of the one before (methods 3).

A level follows from its predecessor by merging places that edges connect. The collapses are chosen
once, by least quadric error; positions and attributes of the merged vertices follow from the mesh.
So a mesh that deforms without changing its topology gets its levels by the same collapses.

References
----------
Garland and Heckbert, *Surface simplification using quadric error metrics*, SIGGRAPH 1997; the
collapses are those of fast-simplification.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...snapshot.content import MeshSnapshot, next_uid
from .level_attributes import carry
from .level_collapses import Halving, decimate
from .level_errors import LevelErrors
from .level_seams import following_seams, materials_meet, seam_edges
from .level_step import Step
from .level_surface import Surface, connected, differ, stable_order, weld

__all__ = [
    "Halving",
    "MeshLevel",
    "available",
    "replay",
    "seam_edges",
    "simplify",
    "slots_of",
    "surviving",
]

# Largest share of its predecessor's triangles that a level may keep to be worth its memory.
_LEAST_REDUCTION = 0.75
# Largest relative change of a material's share of the surface, where its borders are too many to be
# held as seams: light may differ by as much.
_MOST_DRIFT = 0.003


@dataclass(frozen=True, eq=False)
class MeshLevel(MeshSnapshot):
    """A level of detail, and the merging of the level before into it.

    Parameters
    ----------
    places : ndarray of shape (V,)
        int32; the place of each vertex of the level before: those of one place are the sides of a
        seam.
    merged : ndarray of shape (V,)
        int32; the vertex of this level that each of those was merged into; -1 where none is left.
    errors : LevelErrors
        Against full detail.
    """

    places: np.ndarray | None = None
    merged: np.ndarray | None = None
    errors: LevelErrors = LevelErrors()


def available():
    """Return whether fast-simplification is installed; some platforms lack it."""
    try:
        import fast_simplification  # noqa: F401
    except ImportError:
        return False
    return True


def simplify(mesh, least_triangles, check=None, seams=None):
    """Make the levels of a mesh.

    Parameters
    ----------
    mesh : MeshSnapshot
    least_triangles : int
        No level has fewer, unless the mesh itself has.
    check : callable, optional
        Called now and then with the triangles that the mesh has lost so far; it may raise to end
        the work.
    seams : ndarray of shape (E, 2), optional
        See `seam_edges`; default: those of the mesh.

    Returns
    -------
    levels : tuple of MeshLevel
        From level 1 up; empty if the mesh cannot be simplified, or none can (see `available`).
    halvings : tuple of Halving
        One a level.
    """
    if not available():
        return (), ()
    places = weld(mesh.positions)
    if seams is None:
        seams = seam_edges(mesh, places)
    levels, halvings = [], []
    shares = _shares(mesh) if len(seams) == 0 and materials_meet(mesh, places) else None
    full, parts = len(mesh.triangles), None
    while len(mesh.triangles) >= 2 * least_triangles:
        watch = None if check is None else partial(check, full - len(mesh.triangles))
        surface = Surface(mesh, places, seams, parts)
        halving = decimate(surface, len(mesh.triangles) // 2, mesh.slots, watch)
        level, places, parts, seams = _merge(mesh, surface, halving)
        if not 0 < len(level.triangles) <= _LEAST_REDUCTION * len(mesh.triangles):
            break
        if shares is not None and _drift(shares, _shares(level)) > _MOST_DRIFT:
            break
        levels.append(level)
        halvings.append(halving)
        mesh = level
    return tuple(levels), tuple(halvings)


def _shares(mesh):
    """Return the share of the area that each material slot has, as a dictionary."""
    a, b, c = (mesh.positions[corner].astype(np.float64) for corner in mesh.triangles.T)
    sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    total = max(float(sizes.sum()), 1e-300)
    shares = {}
    for slot, first, count in mesh.slots:
        shares[slot] = shares.get(slot, 0.0) + float(sizes[first : first + count].sum()) / total
    return shares


def _drift(before, after):
    """Return the largest relative change of a share."""
    return max(abs(after.get(slot, 0.0) - x) / x for slot, x in before.items() if x > 0.0)


def replay(mesh, halvings, places=None):
    """Make the levels of a mesh of the same topology by the same collapses.

    Parameters
    ----------
    mesh : MeshSnapshot
        With the triangles of the mesh that was simplified; its positions may differ.
    halvings : sequence of Halving
    places : ndarray of shape (V,), optional
        Places of its vertices, if these are split differently from those of the mesh that was
        simplified; both have the same triangles between the same places. Default: the same
        splitting.

    Returns
    -------
    tuple of MeshLevel
    """
    levels, parts = [], None
    own = places is not None
    for halving in halvings:
        if own:
            halving = replace(halving, places=places)
        surface = Surface(mesh, halving.places, halving.seams, parts)
        mesh, places, parts, _ = _merge(mesh, surface, halving)
        levels.append(mesh)
    return tuple(levels)


def _merge(mesh, surface, halving):
    """Return the next level, the place of each of its vertices, and the places' parts and seams."""
    place = halving.groups[halving.places]
    kept = surviving(surface.faces, halving.groups[surface.faces])
    old = mesh.triangles[kept]
    vertex_of, vertex_places = _vertices(mesh, halving, place, old)
    triangles = np.ascontiguousarray(vertex_of[old], np.int32)
    step = Step(mesh, surface, halving.groups, vertex_of, vertex_places, triangles)
    points = step.points
    positions = np.ascontiguousarray(points[vertex_places], np.float32)
    attributes, errors = carry(step, positions)
    before = mesh.errors if isinstance(mesh, MeshLevel) else LevelErrors()
    # A side of a seam that has vanished is replaced by another side of its place.
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
        errors=before + errors,
        merged=np.where(vertex_of >= 0, vertex_of, vertex_at[place]).astype(np.int32),
    )
    following = _without_gaps(vertex_places)
    parts = np.zeros(int(following.max(initial=-1)) + 1, step.parts.dtype)
    parts[following] = step.parts[vertex_places]
    number = np.full(len(points), -1, np.int32)
    number[vertex_places] = following
    return level, following, parts, following_seams(surface.seams, number[halving.groups])


def surviving(before, corners):
    """Return the triangles that stay: not degenerate, and no duplicates.

    Where two triangles that face each other have come to coincide, the volume between them has
    vanished, and both are removed, unless they coincided before.

    Parameters
    ----------
    before, corners : ndarray of shape (T, 3)
        Places of their corners, before and after places merge.

    Returns
    -------
    ndarray of shape (K,)
        Indices, rising.
    """
    kept = np.flatnonzero(_proper(corners) & _proper(before))
    several = kept[_perhaps_several(corners[kept])]
    if len(several) == 0:
        return kept
    faces = corners[several]
    order, starts = _runs(np.sort(faces, axis=1))
    run = np.cumsum(starts) - 1
    faces, old = faces[order], np.sort(before[several[order]], axis=1)
    a, b, c = faces.T
    # The cyclic order of the corners gives the orientation of a triangle.
    side = np.where((a < b) ^ (b < c) ^ (c < a), 1, -1)
    first = np.flatnonzero(starts)
    fresh = np.logical_or.reduceat((old != old[first[run]]).any(axis=1), first)
    balance = np.add.reduceat(side, first)
    count = np.diff(np.append(first, len(order)))
    goes = fresh & (balance == 0) & (count > 1)
    stays = np.ones(len(before), bool)
    stays[several] = False
    stays[several[order[first[~goes]]]] = True
    return kept[stays[kept]]


def _proper(faces):
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def _perhaps_several(faces):
    """Return which triangles may have the same corners as another one, by a hash."""
    # Sums of random numbers do not depend on the order.
    label = np.random.default_rng(0).integers(0, 1 << 24, int(faces.max(initial=-1)) + 1)
    bits = min(int(4 * len(faces)).bit_length(), 24)
    bucket = sum(label[corner] for corner in faces.T) & ((1 << bits) - 1)
    return np.bincount(bucket)[bucket] > 1


def _runs(rows):
    """Sort rows of three; return their order and where a row differs from the one before."""
    order = np.arange(len(rows))
    for column in rows.T[::-1]:
        order = order[stable_order(column[order])]
    ordered = rows[order]
    starts = np.ones(len(rows), bool)
    starts[1:] = differ(ordered[1:], ordered[:-1])
    return order, starts


def slots_of(slots, kept):
    """Return the material slots of the kept triangles, which are still sorted by slot.

    Parameters
    ----------
    slots : sequence of (int, int, int)
        Material slot, first triangle and count, of all triangles.
    kept : ndarray of shape (K,)
        Indices of triangles, rising.

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

    Parameters
    ----------
    mesh : MeshSnapshot
    halving : Halving
    place : ndarray of shape (V,)
        Merged place of each vertex.
    kept : ndarray of shape (T, 3)
        Vertices of the kept triangles.

    Returns
    -------
    vertex_of : ndarray of shape (V,)
        New vertex that each old one was merged into, -1 where it is gone.
    vertex_places : ndarray of shape (W,)
        int32; the merged place of each new vertex.
    """
    key = place
    if len(mesh.positions) > len(halving.groups):
        # The sides of a seam stay separate, even where the seam does not divide the mesh.
        side = _sides(mesh.triangles, halving.places, place)
        order = stable_order(side)
        order = order[stable_order(place[order])]
        starts = np.zeros(len(order), bool)
        starts[1:] = (np.diff(place[order]) != 0) | (np.diff(side[order]) != 0)
        key = np.empty(len(order), np.int32)
        key[order] = np.cumsum(starts)
    used = np.zeros(int(key.max(initial=-1)) + 1, bool)
    used[key[kept]] = True
    number = np.where(used, np.cumsum(used, dtype=np.int32) - 1, -1).astype(np.int32)
    vertex_of = number[key]
    found = vertex_of >= 0
    vertex_places = np.empty(int(used.sum()), np.int32)
    vertex_places[vertex_of[found]] = place[found]
    return vertex_of, vertex_places


def _without_gaps(numbers):
    seen = np.zeros(int(numbers.max(initial=-1)) + 1, bool)
    seen[numbers] = True
    return (np.cumsum(seen, dtype=np.int32) - 1)[numbers]


def _sides(triangles, places, merged):
    """Return numbers of the sides of seams at merging places: vertices that triangles connect.

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
