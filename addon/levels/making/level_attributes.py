"""Vertex attributes of a level of detail: colours, normals, UVs.

Colours and normals are a least-squares fit to the old ones over the surface: the old vertices are
projected to the new triangles, and the interpolated values fitted there. Each part keeps the mean
of every attribute over its surface. Colours that were not negative stay so, and light stays on its
side of the surface. The mean is kept and not the integral: fine wrinkles are lost with their area,
but the visible surface does not get smaller. Texture coordinates are read at the place of the old
triangles nearest to a new vertex, so that they stay inside their part of the texture.

References
----------
Lucy, *An iterative technique for the rectification of observed distributions*, Astronomical
Journal 79, 1974: steps of a fit that keep the sign and the total.
"""

import numpy as np

from .level_errors import ErrorMeter, LevelErrors, edge_length, is_coordinate, moved_by_pairs
from .level_parts import mixed
from .level_projection import vertex_areas
from .level_surface import facets

# Steps of conjugate gradients, preconditioned by the vertices' areas; they converge to a hundredth
# of the values' deviation.
_STEPS = 6
# Weight of the plain mean in the fit: it decides where there are few samples.
_MEAN_WEIGHT = 0.1
# Least value of a non-negative channel, in means of the merged ones, so that factors can raise it.
_LEAST_SHARE = 0.01
# Richardson-Lucy steps after the least squares.
_LUCY_STEPS = 2
# Largest change of values to keep light on its side of the surface.
_MOST_GAIN = 1.2
# Steps by which the mean of the normals is kept; each is exact but for their length.
_NORMAL_STEPS = 2


def carry(step, positions):
    """Return the attributes of the next level.

    Parameters
    ----------
    step : Step
    positions : ndarray of shape (W, 3)
        The new level's.

    Returns
    -------
    attributes : dict of str to ndarray of shape (W, k)
        float32.
    errors : LevelErrors
        Against the level before.
    """
    mesh = step.mesh
    if not mesh.attributes or len(positions) == 0:
        errors = LevelErrors(moved_by_pairs(step) * edge_length(step))
        return {key: old[:0] for key, old in mesh.attributes.items()}, errors
    result = {}
    fit, meter = _Fit(step, positions), ErrorMeter(step, positions)
    for key, old in mesh.attributes.items():
        if is_coordinate(key):
            values = fit.inside(old)
        else:
            values = fit.solve(old, direction=key == "normal")
        if key == "normal":
            values = _upright_facets(values, positions, step)
            values = fit.leaning(_unit(values), old)
        meter.add(key, values, old)
        result[key] = np.ascontiguousarray(values, np.float32)
    return result, meter.found()


class _Fit:
    """Least squares over samples of the old surface."""

    def __init__(self, step, positions):
        self._step, self._projection = step, step.projection
        self._count = len(positions)
        self._old = step.old_areas
        self._new = vertex_areas(facets(positions, step.triangles), step.triangles, self._count)
        length = np.sqrt(np.square(self._new[:3]).sum(axis=0))
        self._slopes = np.ones((4, self._count))
        self._slopes[:3] = self._new[:3] / np.maximum(length, 1e-300)
        self._part_count = step.surface.part_count
        several = self._part_count > 1
        self._old_part = step.part_of_old() if several else None
        self._new_part = step.part_of_new() if several else None
        self._old_size = self._of_old(self._old[3])
        self._new_size = np.maximum(self._of_new(self._new[3]), 1e-300)

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
            x = self._least_squares(every[self._projection.members], positive)
            if positive:
                x = self._mixed(self._with_light(x, every), every)
            elif not direction:
                x += self._spread(self._missing(x, every))
            channel[:] = x
        return result

    def inside(self, values):
        """Return the values at the new vertices that fit, each between those it was merged from.

        Parameters
        ----------
        values : ndarray of shape (V, k)

        Returns
        -------
        ndarray of shape (W, k)
        """
        result = np.empty((self._count, values.shape[1]))
        for channel, every in zip(result.T, values.T, strict=True):
            old = every[self._projection.members].astype(np.float64)
            channel[:] = self._least_squares(old, False, 0.0, 0.01)
        return result

    def leaning(self, normals, old):
        """Return unit normals with the old mean over each part, as far as possible.

        Parameters
        ----------
        normals : ndarray of shape (W, 3)
        old : ndarray of shape (V, 3)
        """
        for _ in range(_NORMAL_STEPS):
            leant = normals.copy()
            for x, y in zip(leant.T, old.T, strict=True):
                x += self._spread(self._missing(x, y.astype(np.float64)))
            normals = _unit(leant)
        return normals

    def _least_squares(self, old, positive, widening=1.0, mean_weight=_MEAN_WEIGHT):
        samples = self._projection
        mean = np.add.reduceat(samples.area * old, samples.first) / samples.mass
        still = samples.gather_still(old)
        wanted = samples.gather(old[samples.moved]) + still + mean_weight * samples.mass * mean
        x = mean.copy()
        residual = wanted - self._image(x, mean_weight)
        direction = residual / samples.mass
        # Sums, not dot products: the threads of those would compete with the viewport's.
        length = (residual * direction).sum()
        for _ in range(_STEPS):
            image = self._image(direction, mean_weight)
            step = length / max((direction * image).sum(), 1e-300)
            x += step * direction
            residual -= step * image
            scaled = residual / samples.mass
            following = (residual * scaled).sum()
            direction = scaled + following / max(length, 1e-300) * direction
            length = following
        # Bounded by the range of the old values, widened by as much again.
        low = np.minimum.reduceat(old, samples.first)
        high = np.maximum.reduceat(old, samples.first)
        spread = widening * (high - low)
        low, high = low - spread, high + spread
        if not positive:
            return np.clip(x, low, high)
        x = np.clip(x, np.maximum(low, _LEAST_SHARE * mean), high)
        # What the bounds have added is subtracted from the neighbours.
        hold = mean_weight * samples.mass
        whole = samples.gather(1.0) + samples.still_mass + hold
        least = max(old.max(), 1e-300) * 1e-12
        for _ in range(_LUCY_STEPS):
            share = old[samples.moved] / np.maximum(samples.at(x), least)
            x = (x * samples.gather(share) + still + hold * mean) / whole
        return x

    def _image(self, x, mean_weight):
        """Apply the matrix of the normal equations."""
        samples = self._projection
        hold = mean_weight * samples.mass + samples.still_mass
        return samples.gather(samples.at(x)) + hold * x

    def _with_light(self, x, every):
        """Scale values so that each part keeps their mean, and their first moment over direction.

        Blurred colours carry light from the lit side of a surface to the other, which would change
        the brightness of each side.
        """
        wanted = np.stack([self._of_old(row) for row in self._old * every])
        wanted[3] *= self._new_size / np.maximum(self._old_size, 1e-300)
        found = self._new * x
        system = np.stack(
            [[self._of_new(row * slope) for slope in self._slopes] for row in found]
        ).transpose(2, 0, 1)
        missing = wanted - np.stack([self._of_new(row) for row in found])
        scale = np.maximum(wanted[3], 1e-300)
        gain = np.linalg.pinv(system / scale[:, None, None], rcond=1e-6)
        gain = np.einsum("nij,nj->in", gain, (missing / scale).T)
        factor = 1.0 + sum(
            self._spread(g) * slope for g, slope in zip(gain, self._slopes, strict=True)
        )
        x = x * np.clip(factor, 1.0 / _MOST_GAIN, _MOST_GAIN)
        # Correct the mean after clipping.
        total = self._of_new(self._new[3] * x)
        return x * self._spread(np.where(total > 0.0, wanted[3] / np.maximum(total, 1e-300), 1.0))

    def _mixed(self, x, every):
        """Give parts that have absorbed others the mean of both colours, vertex by vertex."""
        step = self._step
        if step.pairs is None:
            return x
        factor, summand = mixed(step.surface, step.mesh, step.pairs, every)
        stays = np.zeros(self._part_count, bool)
        stays[step.pairs.stays] = True
        places = step.surface.places
        part = step.surface.parts[places]
        kept = np.flatnonzero(stays[part] & ~step.pairs.passengers[places] & (step.vertex_of >= 0))
        x = x.copy()
        x[step.vertex_of[kept]] = every[kept] * factor[part[kept]] + summand[part[kept]]
        return x

    def _missing(self, x, every):
        """Return the difference of the mean over each part from the old one."""
        wanted = self._of_old(self._old[3] * every) / np.maximum(self._old_size, 1e-300)
        return wanted - self._of_new(self._new[3] * x) / self._new_size

    def _of_old(self, values):
        """Return the sum over the old vertices of each part."""
        if self._old_part is None:
            return np.array([values.sum()])
        return np.bincount(self._old_part, values, self._part_count)

    def _of_new(self, values):
        if self._new_part is None:
            return np.array([values.sum()])
        return np.bincount(self._new_part, values, self._part_count)

    def _spread(self, of_parts):
        """Return the value of each new vertex' part."""
        return of_parts[0] if self._new_part is None else of_parts[self._new_part]


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)


def _upright_facets(normals, positions, step):
    """Give vertices with a single triangle (of flat facets) that triangle's normal."""
    triangles = step.triangles
    uses = np.bincount(triangles.ravel(), minlength=len(positions))
    # Vertices that have got a single triangle only now belong to a smooth side of a seam.
    samples = step.projection
    before = np.bincount(step.mesh.triangles.ravel(), minlength=len(step.mesh.positions))
    before = np.maximum.reduceat(before[samples.members], samples.first)
    alone = ((uses == 1) & (before == 1)) | (np.square(normals).sum(axis=1) < 1e-12)
    if not alone.any():
        return normals
    across = facets(positions, triangles).T
    facet = np.zeros((len(positions), 3))
    for corner in triangles.T:
        facet[corner] = across
    facing = np.where((facet * normals).sum(axis=1, keepdims=True) < 0.0, -facet, facet)
    return np.where(alone[:, None], facing, normals)
