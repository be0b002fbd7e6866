"""Projection of a level's vertices to the triangles of the next level of detail."""

import numpy as np

from .level_surface import differ, stable_order

# Pairs of a point and a triangle that are processed at once; they fit into a cache.
_BLOCK = 1 << 15


class Projection:
    """The old vertices on the new triangles: samples of the old surface, by their areas.

    Parameters
    ----------
    old_positions : ndarray of shape (V, 3)
    old_areas : ndarray of shape (4, V)
        See `vertex_areas`.
    vertex_of : ndarray of shape (V,)
        New vertex that each old one was merged into, -1 where it is gone.
    positions : ndarray of shape (W, 3)
    triangles : ndarray of shape (T, 3)
        The new level's.

    Attributes
    ----------
    members : ndarray of shape (M,)
        Old vertices that became new ones, sorted by these.
    owner : ndarray of shape (M,)
        The new vertex of each.
    area : ndarray of shape (M,)
        The area that each stands for.
    first : ndarray of shape (W,)
        Where each new vertex' members begin.
    mass : ndarray of shape (W,)
        Sum of its members' areas.
    still, moved : ndarray
        Indices of members: those that did not move lie at their vertex and need no search.
    still_mass : ndarray of shape (W,)
        Area of the members of each new vertex that did not move.
    """

    def __init__(self, old_positions, old_areas, vertex_of, positions, triangles):
        self.count = len(positions)
        members = np.flatnonzero(vertex_of >= 0)
        self.members = members[stable_order(vertex_of[members])]
        self.owner = owner = vertex_of[self.members]
        self.area = old_areas[3][self.members]
        self.first = np.flatnonzero(np.append(True, owner[1:] != owner[:-1])[: len(owner)])
        self.mass = np.add.reduceat(self.area, self.first) if len(owner) else np.zeros(0)
        samples = old_positions[self.members]
        moved = differ(samples, positions[owner])
        self.still, self.moved = np.flatnonzero(~moved), np.flatnonzero(moved)
        best, self.weights = closest(
            samples[self.moved],
            owner[self.moved],
            Fans(triangles, self.count),
            positions,
            triangles,
        )
        lost = best < 0
        corners = triangles[best]
        corners[lost] = owner[self.moved[lost], None]
        self.corners = np.ascontiguousarray(corners.T)
        self.still_mass = np.bincount(owner[self.still], self.area[self.still], self.count)
        self.moved_area = self.area[self.moved]

    def at(self, values):
        """Interpolate values of the new vertices, shape (W,), at the samples that moved."""
        return sum(w * values[corner] for w, corner in zip(self.weights, self.corners, strict=True))

    def gather(self, moved):
        """Return, for each vertex, the sum of its samples' values, weighted by area."""
        moved = self.moved_area * moved
        result = np.zeros(self.count)
        for w, corner in zip(self.weights, self.corners, strict=True):
            result += np.bincount(corner, w * moved, self.count)
        return result

    def gather_still(self, values):
        """Return, for each vertex, the area-weighted sum of its samples that did not move.

        Parameters
        ----------
        values : ndarray of shape (M,)
            Of all members.
        """
        weighted = self.area[self.still] * values[self.still]
        return np.bincount(self.owner[self.still], weighted, self.count)


class Fans:
    """The triangles at each vertex.

    Parameters
    ----------
    triangles : ndarray of shape (T, 3)
        Vertices; corners below 0 do not count.
    count : int
        Of the vertices.
    """

    def __init__(self, triangles, count):
        corner = triangles.ravel()
        whole = np.flatnonzero(corner >= 0) if len(corner) and corner.min() < 0 else slice(None)
        corner = corner[whole]
        order = stable_order(corner)
        if not isinstance(whole, slice):
            order = whole[order]
        self.faces = (order // 3).astype(np.int32)
        self.uses = np.bincount(corner, minlength=count)
        self.first = np.cumsum(self.uses) - self.uses


def closest(points, vertex, fans, positions, triangles):
    """Find, for each point, the nearest place on the triangles of a vertex.

    Parameters
    ----------
    points : ndarray of shape (M, 3)
    vertex : ndarray of shape (M,)
    fans : Fans
    positions, triangles : ndarray

    Returns
    -------
    best : ndarray of shape (M,)
        The triangle, -1 where there is none.
    weights : ndarray of shape (3, M)
        Of its corners; one third where there is none.
    """
    best = np.full(len(points), -1, np.int64)
    weights = np.full((3, len(points)), 1.0 / 3.0)
    uses = fans.uses[vertex]
    with_any = np.flatnonzero(uses)
    pairs = np.cumsum(uses[with_any])
    done = 0
    while done < len(with_any):
        before = pairs[done - 1] if done else 0
        stop = max(int(np.searchsorted(pairs, before + _BLOCK, side="right")), done + 1)
        block = with_any[done:stop]
        many = uses[block]
        starts = np.cumsum(many) - many
        index = np.arange(starts[-1] + many[-1])
        index += np.repeat(fans.first[vertex[block]] - starts, many)
        face = fans.faces[index]
        # Relative to the point, single precision is enough.
        at = np.repeat(points[block], many, axis=0)
        a, b, c = ((positions[corner] - at).T for corner in triangles[face].T)
        v, w, distance = _nearest_weights(a, b, c)
        winner = np.flatnonzero(distance <= np.repeat(np.minimum.reduceat(distance, starts), many))
        # The first of equals.
        winner = winner[np.searchsorted(winner, starts)]
        best[block] = face[winner]
        weights[1, block], weights[2, block] = v[winner], w[winner]
        weights[0, block] = 1.0 - weights[1, block] - weights[2, block]
        done = stop
    return best, weights


def _nearest_weights(a, b, c):
    """Find the place of each triangle nearest to the origin.

    Parameters
    ----------
    a, b, c : ndarray of shape (3, K)
        Corners.

    Returns
    -------
    v, w : ndarray of shape (K,)
        The weights of b and c.
    distance : ndarray of shape (K,)
        Squared, as far as it differs among the triangles of one a; see below.
    """
    u, e, a = np.ascontiguousarray(b - a), np.ascontiguousarray(c - a), np.ascontiguousarray(a)
    d00, d01, d11, d20, d21 = (
        x[0] * y[0] + x[1] * y[1] + x[2] * y[2] for x, y in ((u, u), (u, e), (e, e), (u, a), (e, a))
    )
    d20, d21 = -d20, -d21
    tiny = np.finfo(d00.dtype).tiny
    area = np.maximum(d00 * d11 - d01 * d01, tiny)
    v = (d11 * d20 - d01 * d21) / area
    w = (d00 * d21 - d01 * d20) / area
    # Otherwise the nearest place of the three edges.
    outside = np.flatnonzero(~((v >= 0.0) & (w >= 0.0) & (v + w <= 1.0)))
    e00, e01, e11, e20, e21 = (d[outside] for d in (d00, d01, d11, d20, d21))
    on_ab = np.clip(e20 / np.maximum(e00, tiny), 0.0, 1.0)
    on_ac = np.clip(e21 / np.maximum(e11, tiny), 0.0, 1.0)
    side = np.maximum(e00 - 2.0 * e01 + e11, tiny)
    on_bc = np.clip((e00 - e01 - e20 + e21) / side, 0.0, 1.0)
    rest = 1.0 - on_bc
    # |a + v u + w e|^2 without its constant part.
    cost = on_ab * (on_ab * e00 - 2.0 * e20)
    other = on_ac * (on_ac * e11 - 2.0 * e21)
    second = other < cost
    cost = np.where(second, other, cost)
    other = rest * (rest * e00 + 2.0 * on_bc * e01 - 2.0 * e20) + on_bc * (on_bc * e11 - 2.0 * e21)
    third = other < cost
    v[outside] = np.where(third, rest, np.where(second, 0.0, on_ab))
    w[outside] = np.where(third, on_bc, np.where(second, on_ac, 0.0))
    distance = sum((p + v * q + w * r) ** 2 for p, q, r in zip(a, u, e, strict=True))
    return v, w, distance


def vertex_areas(normal, triangles, count):
    """Return a third of the area of the triangles round each vertex.

    Parameters
    ----------
    normal : ndarray of shape (3, T)
        Of the triangles, twice their area long.
    triangles : ndarray of shape (T, 3)
    count : int
        Of the vertices.

    Returns
    -------
    ndarray of shape (4, count)
        As a vector, and without its direction; the latter is never quite 0.
    """
    size = np.sqrt(np.square(normal).sum(axis=0))
    areas = np.zeros((4, count))
    for total, values in zip(areas, (*normal, size), strict=True):
        share = values / 6.0
        for corner in triangles.T:
            total += np.bincount(corner, share, count)
    areas[3] += max(float(areas[3].mean()) if count else 0.0, 1e-30) * 1e-6
    return areas
