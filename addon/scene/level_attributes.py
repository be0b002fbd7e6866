"""What the vertices of a level of detail carry.

Colours and normals are those that come nearest, in the mean square over the surface, to the old
ones: the old vertices are projected to the new triangles, and the values there fitted by least
squares. UVs are read where a new vertex lies nearest to the old triangles, so that they stay inside
their part of the texture.
"""

import numpy as np

# Steps of conjugate gradients; the fit is local and well conditioned.
_STEPS = 8
# Share of a plain mean in the fit: where few samples lie, it decides.
_MEAN_WEIGHT = 0.1


def carry(mesh, vertex_of, positions, triangles):
    """Return the attributes of the next level.

    Parameters
    ----------
    mesh : MeshSnapshot
        The level before.
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
        fit = _Fit(mesh, vertex_of, positions, triangles)
        for key in fitted:
            values = fit.solve(mesh.attributes[key])
            if key == "normal":
                values = _upright_facets(values, positions, triangles)
                values /= np.maximum(np.linalg.norm(values, axis=1, keepdims=True), 1e-30)
            result[key] = np.ascontiguousarray(values, np.float32)
    read = [key for key in mesh.attributes if key.startswith("uv:")]
    if read:
        corners, weights = _places_in_old(mesh, vertex_of, positions)
        for key in read:
            values = (weights[:, :, None] * mesh.attributes[key][corners]).sum(axis=1)
            result[key] = np.ascontiguousarray(values, np.float32)
    return {key: result[key] for key in mesh.attributes}


class _Fit:
    """Least squares over samples of the old surface."""

    def __init__(self, mesh, vertex_of, positions, triangles):
        self._members = np.flatnonzero(vertex_of >= 0)
        self._owner = vertex_of[self._members]
        self._area = _vertex_areas(mesh)[self._members]
        self._count = len(positions)
        samples = mesh.positions[self._members].astype(np.float64)
        owner, face = _incident(self._owner, triangles, self._count)
        best, weights = _closest(samples, owner, face, positions, triangles)
        lost = best < 0
        self._corners = triangles[np.maximum(best, 0)].astype(np.int64)
        self._corners[lost] = self._owner[lost, None]
        self._weights = weights
        self._mass = np.bincount(self._owner, self._area, self._count)

    def solve(self, values):
        """Return the values at the new vertices that fit those at the old ones."""
        old = values[self._members].astype(np.float64)
        mean = self._gather(self._owner[:, None], np.ones((len(old), 1)), old)
        start = mean / np.maximum(self._mass, 1e-300)[:, None]
        x = start.copy()
        residual = self._gather(self._corners, self._weights, old - self._at(x))
        direction = residual.copy()
        length = np.square(residual).sum(axis=0)
        for _ in range(_STEPS):
            image = self._gather(self._corners, self._weights, self._at(direction))
            image += _MEAN_WEIGHT * self._mass[:, None] * direction
            step = length / np.maximum((direction * image).sum(axis=0), 1e-300)
            x += step * direction
            residual -= step * image
            following = np.square(residual).sum(axis=0)
            direction = residual + following / np.maximum(length, 1e-300) * direction
            length = following
        return self._bounded(x, old)

    def _at(self, x):
        return np.einsum("ik,ikj->ij", self._weights, x[self._corners])

    def _gather(self, corners, weights, values):
        result = np.zeros((self._count, values.shape[1]))
        for k in range(corners.shape[1]):
            w = self._area * weights[:, k]
            for j in range(values.shape[1]):
                result[:, j] += np.bincount(corners[:, k], w * values[:, j], self._count)
        return result

    def _bounded(self, x, old):
        """Keep values within the range of the old ones, widened by as much again."""
        order = np.argsort(self._owner, kind="stable")
        first = np.searchsorted(self._owner[order], np.arange(self._count))
        low = np.minimum.reduceat(old[order], first, axis=0)
        high = np.maximum.reduceat(old[order], first, axis=0)
        spread = high - low
        # What has no negative values gets none.
        floor = np.where(low >= 0.0, np.maximum(low - spread, 0.0), low - spread)
        return np.clip(x, floor, high + spread)


def _incident(points_owner, triangles, count):
    """Return pairs of a point's index and a triangle at the vertex that owns it."""
    corner = triangles.ravel()
    order = np.argsort(corner, kind="stable")
    uses = np.bincount(corner, minlength=count)
    first = np.cumsum(uses) - uses
    many = uses[points_owner]
    point = np.repeat(np.arange(len(points_owner)), many)
    start = np.cumsum(many) - many
    within = np.arange(len(point)) - start[point]
    return point, order[first[points_owner[point]] + within] // 3


def _closest(points, owner, face, positions, triangles):
    """Find, for each point, the nearest place on the triangles it is paired with.

    Parameters
    ----------
    points : ndarray of shape (M, 3)
    owner, face : ndarray of shape (K,)
        Pairs of a point and a triangle, sorted by the point.
    positions, triangles : ndarray

    Returns
    -------
    best : ndarray of shape (M,)
        The triangle, -1 where a point has none.
    weights : ndarray of shape (M, 3)
        Of its corners; one third where there is none.
    """
    best = np.full(len(points), -1, np.int64)
    weights = np.full((len(points), 3), 1.0 / 3.0)
    if len(owner) == 0:
        return best, weights
    a, b, c = (positions[triangles[face, k]].astype(np.float64) for k in range(3))
    p = points[owner]
    place = _nearest_weights(p, a, b, c)
    nearest = place[:, :1] * a + place[:, 1:2] * b + place[:, 2:] * c
    distance = np.einsum("ij,ij->i", nearest - p, nearest - p)
    starts = np.flatnonzero(np.append(True, owner[1:] != owner[:-1]))
    least = np.minimum.reduceat(distance, starts)
    run = np.cumsum(np.append(True, owner[1:] != owner[:-1])) - 1
    winner = np.flatnonzero(distance <= least[run])
    first = winner[np.append(True, run[winner][1:] != run[winner][:-1])]
    best[owner[first]] = face[first]
    weights[owner[first]] = place[first]
    return best, weights


def _nearest_weights(p, a, b, c):
    """Return the barycentric weights of the place of triangles nearest to points."""
    ab, ac, ap = b - a, c - a, p - a
    d00, d01, d11, d20, d21 = (
        np.einsum("ij,ij->i", x, y) for x, y in ((ab, ab), (ab, ac), (ac, ac), (ap, ab), (ap, ac))
    )
    area = np.maximum(d00 * d11 - d01 * d01, 1e-300)
    v = (d11 * d20 - d01 * d21) / area
    w = (d00 * d21 - d01 * d20) / area
    inside = (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0)
    # Otherwise the nearest place of the three edges.
    on_ab = np.clip(d20 / np.maximum(d00, 1e-300), 0.0, 1.0)
    on_ac = np.clip(d21 / np.maximum(d11, 1e-300), 0.0, 1.0)
    side = d00 - 2.0 * d01 + d11
    on_bc = np.clip((d00 - d01 - d20 + d21) / np.maximum(side, 1e-300), 0.0, 1.0)
    zero = np.zeros_like(v)
    options = [(on_ab, zero), (zero, on_ac), (1.0 - on_bc, on_bc)]
    # |ap - v ab - w ac|^2 without its constant part.
    costs = [
        x * x * d00 + y * y * d11 + 2.0 * x * y * d01 - 2.0 * (x * d20 + y * d21)
        for x, y in options
    ]
    choice = np.argmin(costs, axis=0)
    edge_v = np.choose(choice, [x for x, _ in options])
    edge_w = np.choose(choice, [y for _, y in options])
    v, w = np.where(inside, v, edge_v), np.where(inside, w, edge_w)
    return np.stack([1.0 - v - w, v, w], axis=1)


def _places_in_old(mesh, vertex_of, positions):
    """Return the old corners, and their weights, where the new vertices lie nearest."""
    owner = vertex_of[mesh.triangles]
    pairs = [np.stack([owner[:, k], np.arange(len(owner))]) for k in range(3)]
    point, face = np.concatenate(pairs, axis=1)
    order = np.lexsort((face, point))
    order = order[point[order] >= 0]
    best, weights = _closest(
        positions.astype(np.float64), point[order], face[order], mesh.positions, mesh.triangles
    )
    return mesh.triangles[best], weights


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
