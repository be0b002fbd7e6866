"""What the vertices of a level of detail carry.

Colours and normals are those that come nearest, in the mean square over the surface, to the old
ones: the old vertices are projected to the new triangles, and the values there fitted by least
squares. What was not negative is light: it stays so, keeps its integral over the surface,
and stays on its side.
UVs are read where a new vertex lies nearest to the old triangles, so that they stay inside their
part of the texture.

References
----------
Lucy, *An iterative technique for the rectification of observed distributions*, Astronomical
Journal 79, 1974: steps of a fit that keep the sign and the total.
"""

import numpy as np

from .level_collapses import differ, facets, stable_order

# Steps of conjugate gradients, scaled by the vertices' areas; what is left to converge is below a
# hundredth of the values' deviation.
_STEPS = 6
# Share of a plain mean in the fit: where few samples lie, it decides.
_MEAN_WEIGHT = 0.1
# Of a value that is not negative, in means of the merged ones: so it can still grow by a factor.
_LEAST_SHARE = 0.01
# Steps by Lucy after the least squares.
_LUCY_STEPS = 2
# How far values make up for surface that a level gains or loses: light of a lost twig belongs to
# the tree, but a tree must not glow.
_MOST_AREA_CHANGE = 1.02
# How much values change at most to keep light on its side.
_MOST_GAIN = 1.2
# Pairs of a point and a triangle that are looked at together; their numbers stay in a cache.
_BLOCK = 1 << 15


def carry(mesh, surface, vertex_of, positions, triangles):
    """Return the attributes of the next level.

    Parameters
    ----------
    mesh : MeshSnapshot
        The level before.
    surface : Surface
        Of that level.
    vertex_of : ndarray of shape (V,)
        New vertex that each old one was merged into, -1 where it is gone.
    positions : ndarray of shape (W, 3)
    triangles : ndarray of shape (T, 3)
        The new level's.

    Returns
    -------
    dict of str to ndarray of shape (W, k)
        float32.
    """
    if not mesh.attributes:
        return {}
    result = {}
    fitted = [key for key in mesh.attributes if not key.startswith("uv:")]
    if fitted:
        fit = _Fit(mesh, surface, vertex_of, positions, triangles)
        for key in fitted:
            values = fit.solve(mesh.attributes[key], direction=key == "normal")
            if key == "normal":
                values = _upright_facets(values, positions, triangles)
                values /= np.maximum(np.linalg.norm(values, axis=1, keepdims=True), 1e-30)
            result[key] = np.ascontiguousarray(values, np.float32)
    read = [key for key in mesh.attributes if key.startswith("uv:")]
    if read:
        fans = _Fans(vertex_of[mesh.triangles], len(positions))
        every = np.arange(len(positions))
        best, weights = _closest(positions, every, fans, mesh.positions, mesh.triangles)
        corners = mesh.triangles[best]
        for key in read:
            values = sum(
                weights[k][:, None] * mesh.attributes[key][corners[:, k]] for k in range(3)
            )
            result[key] = np.ascontiguousarray(values, np.float32)
    return {key: result[key] for key in mesh.attributes}


class _Fit:
    """Least squares over samples of the old surface."""

    def __init__(self, mesh, surface, vertex_of, positions, triangles):
        self._count = len(positions)
        members = np.flatnonzero(vertex_of >= 0)
        members = members[stable_order(vertex_of[members])]
        owner = vertex_of[members]
        self._old = _vertex_areas(surface.normal, mesh.triangles, len(mesh.positions))
        self._new = _vertex_areas(facets(positions, triangles), triangles, self._count)
        length = np.sqrt(np.square(self._new[:3]).sum(axis=0))
        self._slopes = np.ones((4, self._count))
        self._slopes[:3] = self._new[:3] / np.maximum(length, 1e-300)
        area = self._old[3][members]
        self._members, self._area = members, area
        self._first = np.flatnonzero(np.append(True, owner[1:] != owner[:-1])[: len(owner)])
        self._mass = np.add.reduceat(area, self._first) if len(area) else np.zeros(0)
        samples = mesh.positions[members]
        # What did not move lies at its vertex, which needs no search.
        moved = differ(samples, positions[owner])
        self._still, self._moved = np.flatnonzero(~moved), np.flatnonzero(moved)
        self._still_owner = owner[self._still]
        best, self._weights = _closest(
            samples[self._moved],
            owner[self._moved],
            _Fans(triangles, self._count),
            positions,
            triangles,
        )
        lost = best < 0
        corners = triangles[best]
        corners[lost] = owner[self._moved[lost], None]
        self._corners = np.ascontiguousarray(corners.T)
        self._still_mass = np.bincount(self._still_owner, area[self._still], self._count)
        self._moved_area = area[self._moved]

    def solve(self, values, direction):
        """Return the values at the new vertices that fit those at the old ones.

        Parameters
        ----------
        values : ndarray of shape (V, k)
        direction : bool
            Whether only their direction counts.

        Returns
        -------
        ndarray of shape (W, k)
        """
        result = np.empty((self._count, values.shape[1]))
        for channel, every in zip(result.T, values.T, strict=True):
            every = every.astype(np.float64)
            least = every.min()
            if least == every.max():
                channel[:] = least
                continue
            positive = least >= 0.0 and not direction
            x = self._least_squares(every[self._members], positive)
            channel[:] = self._with_light(x, every) if positive else x
        return result

    def _least_squares(self, old, positive):
        mean = np.add.reduceat(self._area * old, self._first) / self._mass
        weighted = self._area[self._still] * old[self._still]
        still = np.bincount(self._still_owner, weighted, self._count)
        wanted = self._gather(old[self._moved]) + still + _MEAN_WEIGHT * self._mass * mean
        x = mean.copy()
        residual = wanted - self._image(x)
        direction = residual / self._mass
        # Sums, not dot products: the threads of those would compete with the viewport's.
        length = (residual * direction).sum()
        for _ in range(_STEPS):
            image = self._image(direction)
            step = length / max((direction * image).sum(), 1e-300)
            x += step * direction
            residual -= step * image
            scaled = residual / self._mass
            following = (residual * scaled).sum()
            direction = scaled + following / max(length, 1e-300) * direction
            length = following
        # Within the range of the old ones, widened by as much again.
        low = np.minimum.reduceat(old, self._first)
        high = np.maximum.reduceat(old, self._first)
        spread = high - low
        low, high = low - spread, high + spread
        if not positive:
            return np.clip(x, low, high)
        x = np.clip(x, np.maximum(low, _LEAST_SHARE * mean), high)
        # What the bounds added is taken away again round about.
        hold = _MEAN_WEIGHT * self._mass
        whole = self._gather(np.ones(len(self._moved))) + self._still_mass + hold
        least = max(old.max(), 1e-300) * 1e-12
        for _ in range(_LUCY_STEPS):
            share = old[self._moved] / np.maximum(self._at(x), least)
            x = (x * self._gather(share) + still + hold * mean) / whole
        return x

    def _image(self, x):
        """Apply the matrix of the normal equations."""
        hold = _MEAN_WEIGHT * self._mass + self._still_mass
        return self._gather(self._at(x)) + hold * x

    def _with_light(self, x, every):
        """Scale values to their old integral over the surface, also weighted by its direction.

        A blur of colours carries light from the lit side of a surface to the other one, and each
        side that is seen would change.
        """
        wanted, found = (self._old * every).sum(axis=1), self._new * x
        old, new = self._old[3].sum(), self._new[3].sum()
        change = min(max(old / new, 1.0 / _MOST_AREA_CHANGE), _MOST_AREA_CHANGE)
        wanted *= change * new / old
        system = (found[:, None] * self._slopes).sum(axis=2)
        gain = np.linalg.lstsq(system / new, (wanted - found.sum(axis=1)) / new, rcond=1e-6)[0]
        factor = 1.0 + sum(g * slope for g, slope in zip(gain, self._slopes, strict=True))
        x = x * np.clip(factor, 1.0 / _MOST_GAIN, _MOST_GAIN)
        # What clipping left.
        return x * (wanted[3] / max((self._new[3] * x).sum(), 1e-300))

    def _at(self, x):
        """Return values at the samples that moved."""
        return sum(w * x[corner] for w, corner in zip(self._weights, self._corners, strict=True))

    def _gather(self, moved):
        """Return, for each vertex, the sum of what samples have, by their areas and weights."""
        moved = self._moved_area * moved
        result = np.zeros(self._count)
        for w, corner in zip(self._weights, self._corners, strict=True):
            result += np.bincount(corner, w * moved, self._count)
        return result


class _Fans:
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


def _closest(points, vertex, fans, positions, triangles):
    """Find, for each point, the nearest place on the triangles of a vertex.

    Parameters
    ----------
    points : ndarray of shape (M, 3)
    vertex : ndarray of shape (M,)
    fans : _Fans
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
        # Seen from the point, single precision is enough.
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


def _vertex_areas(normal, triangles, count):
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


def _upright_facets(normals, positions, triangles):
    """Give a vertex of one triangle only, a flat facet's, that facet's own normal."""
    uses = np.bincount(triangles.ravel(), minlength=len(positions))
    alone = (uses == 1) | (np.square(normals).sum(axis=1) < 1e-12)
    if not alone.any():
        return normals
    across = facets(positions, triangles).T
    facet = np.zeros((len(positions), 3))
    for corner in triangles.T:
        facet[corner] = across
    facing = np.where((facet * normals).sum(axis=1, keepdims=True) < 0.0, -facet, facet)
    return np.where(alone[:, None], facing, normals)
