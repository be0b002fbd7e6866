"""Correction of a level's places so that outlines, volumes and silhouettes are kept.

The outline of a sheet or a hole keeps its vector area, which is its projected area from any
direction. Then each part grows or shrinks along its normals until it has its old volume. Surface
area would be a wrong measure: wrinkles that a level loses have area that no silhouette shows.

References
----------
Lindstrom and Turk, *Fast and memory efficient polygonal simplification*, Visualization 1998: volume
and the area inside borders as what simplification preserves.
"""

import numpy as np

from .level_surface import borders, connected, facets

# Largest correction of a place, in square roots of the area round it. Usual corrections are far
# smaller; this keeps crumpled triangles from being turned inside out.
_MOST_MOVE = 0.3
# Least growth of a loop's vector area as it is widened, over the length of its outline: a flat loop
# has 1; one with less is too crumpled to be corrected.
_LEAST_FLATNESS = 0.3
# Share of the surface that a part gains at the same volume which its silhouette gains: measured on
# bodies of several hundred facets with limbs.
_SILHOUETTE_SHARE = 0.55
# Largest gain by facetting, divided by the number of facets; more is by wrinkles, which silhouettes
# do not show. A ball gains 1.2, limbs several times that.
_MOST_EXCESS = 10.0
# A part with fewer facets is about convex: the mean area of its silhouettes is a quarter of its
# surface.
_FEW_FACETS = 64
_MOST_SCALE = 2.0


class Shape:
    """The new triangles between places, and their old counterparts.

    Parameters
    ----------
    surface : Surface
        Of the level before.
    groups : ndarray of shape (P,)
        The new place of each old one.
    parts : ndarray of shape (G,)
        Of the new places.
    whole : ndarray of shape (N,)
        The part that each old one became.
    faces : ndarray of shape (T, 3)
        New places.
    fixed : ndarray of shape (G,)
        bool; places that are not corrected.
    """

    def __init__(self, surface, groups, parts, whole, faces, fixed):
        self._surface, self._groups, self._faces = surface, groups, faces
        self._parts, self._part_count = parts, len(whole)
        self._fixed = fixed
        self._count = len(parts)
        self._whole = whole
        self._face_part = parts[faces[:, 0]]

    def outlined(self, points):
        """Return the places with the old vector areas of the outlines of holes and sheets.

        Parameters
        ----------
        points : ndarray of shape (G, 3)

        Returns
        -------
        ndarray of shape (G, 3)
        """
        old, owner = self._surface.borders
        if len(old) == 0:
            return points
        new, new_owner = borders(self._faces, self._count)
        if len(new) == 0:
            return points
        old = self._groups[old]
        loop = connected(old, self._count)
        # Loops that have met count as one.
        roots = np.stack([np.arange(self._count), loop], axis=1)
        loop = connected(np.concatenate([old, new, roots]), self._count)
        wanted = _vector_area(self._surface.points, self._surface.borders[0], loop[old[:, 0]],
                              self._count)  # fmt: skip
        found = _vector_area(points, new, loop[new[:, 0]], self._count)
        toward = wanted / np.maximum(np.linalg.norm(wanted, axis=1, keepdims=True), 1e-300)
        normal = facets(points, self._faces[new_owner]).T
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        along = points[new[:, 1]] - points[new[:, 0]]
        length = np.linalg.norm(along, axis=1)
        at = loop[new[:, 0]]
        growth = np.bincount(at, length * (normal * toward[at]).sum(axis=1), self._count)
        outline = np.bincount(at, length, self._count)
        edges = np.maximum(np.bincount(at, minlength=self._count), 1)
        flat = (growth > _LEAST_FLATNESS * outline) & _closed(new, at, self._count)
        flat &= _closed(old, loop[old[:, 0]], self._count)
        missing = ((wanted - found) * toward).sum(axis=1)
        step = np.where(flat, missing / np.where(flat, growth, 1.0), 0.0)
        most = _MOST_MOVE * outline / edges
        step = np.clip(step, -most, most)
        outward = np.cross(along, normal)
        direction = np.stack(
            [
                np.bincount(new[:, 0], o, self._count) + np.bincount(new[:, 1], o, self._count)
                for o in outward.T
            ],
            axis=1,
        )
        # Both edges at a place, moved outwards by one, meet there.
        lengths = np.bincount(new.ravel(), np.repeat(length, 2), self._count)
        square = np.square(direction).sum(axis=1)
        direction *= (lengths / np.maximum(square, 0.25 * lengths**2 + 1e-300))[:, None]
        direction[self._fixed] = 0.0
        return points + step[loop][:, None] * direction

    def filled(self, points):
        """Return the places with the old volume and silhouette of each part.

        Parameters
        ----------
        points : ndarray of shape (G, 3)

        Returns
        -------
        ndarray of shape (G, 3)
        """
        surface, count = self._surface, self._part_count
        old_part = self._whole[surface.parts[surface.faces[:, 0]]]
        # As seen from the middle of the part, so that far from the origin nothing cancels.
        middle = np.zeros((count, 3))
        sizes = np.maximum(self._by_part(np.ones(self._count)), 1.0)
        for row, x in zip(middle.T, points.T, strict=True):
            row += self._by_part(x) / sizes
        wanted = _volumes(surface.points, surface.faces, surface.normal, middle, old_part)
        facet, normal, patch = self._normals(points)
        found = _volumes(points, self._faces, facet, middle, self._face_part)
        patch = np.maximum(self._by_part(patch), 1e-300)
        most = _MOST_MOVE * np.sqrt(patch / sizes)
        points = points + self._moved(np.clip((wanted - found) / patch, -most, most), normal)
        # Of bodies of one volume, the one of fewer facets has the larger silhouette.
        facet, normal, _ = self._normals(points)
        area = self._areas(facet)
        old_area = np.bincount(old_part, surface.size, count) / 2.0
        facets_left = np.bincount(self._face_part, minlength=count)
        most_excess = _MOST_EXCESS / np.maximum(facets_left, 1) * area
        lacking = -_SILHOUETTE_SHARE * np.clip(area - old_area, 0.0, most_excess)
        # As a ball would answer; then as the part does.
        trial = 1.5 * lacking * np.abs(wanted) / np.maximum(area, 1e-150) ** 2
        trial = np.clip(trial, -most, most)
        found = self._areas(facets(points + self._moved(trial, normal), self._faces)) - area
        answers = found < 0.5 * lacking
        step = np.where(answers, trial * lacking / np.where(answers, found, 1.0), 0.0)
        points = points + self._moved(np.clip(step, -most, most), normal)
        few = (facets_left <= _FEW_FACETS) & (area > 0.0)
        if not few.any():
            return points
        area = self._areas(facets(points, self._faces))
        scale = np.where(few, np.sqrt(old_area / np.maximum(area, 1e-300)), 1.0)
        scale = np.clip(scale, 1.0 / _MOST_SCALE, _MOST_SCALE)[self._parts][:, None]
        middle = middle[self._parts]
        return np.where(self._fixed[:, None], points, middle + (points - middle) * scale)

    def _areas(self, facet):
        size = np.sqrt(np.square(facet).sum(axis=0))
        return np.bincount(self._face_part, size, self._part_count) / 2.0

    def _moved(self, step, normal):
        """Return the displacements of parts' places along their normals, shape (G, 3)."""
        return (np.where(self._fixed, 0.0, step[self._parts]) * normal).T

    def _normals(self, points):
        """Return the facets, unit normals of the places (3, G), the sizes of their vector areas."""
        facet = facets(points, self._faces)
        normal = np.zeros((3, self._count))
        for total, values in zip(normal, facet / 6.0, strict=True):
            for corner in self._faces.T:
                total += np.bincount(corner, values, self._count)
        size = np.sqrt(np.square(normal).sum(axis=0))
        return facet, normal / np.maximum(size, 1e-300), size

    def _by_part(self, values):
        if self._part_count == 1:
            return np.array([values.sum()])
        return np.bincount(self._parts, values, self._part_count)


def _vector_area(points, edges, loop, count):
    """Return the vector area inside each loop of directed edges, shape (count, 3)."""
    # Seen from one of its own points, so that far from the origin nothing cancels.
    origin = np.zeros((count, 3))
    origin[loop[::-1]] = points[edges[::-1, 0]]
    a, b = (points[end] - origin[loop] for end in edges.T)
    return np.stack([np.bincount(loop, x, count) for x in np.cross(a, b).T / 2.0], axis=1)


def _closed(edges, loop, count):
    """Return which loops are closed: as many edges end at each of their places as begin."""
    balance = np.bincount(edges[:, 0], minlength=count) - np.bincount(edges[:, 1], minlength=count)
    return np.bincount(loop, np.abs(balance[edges[:, 0]]), count) == 0.0


def _volumes(points, faces, normal, middle, part):
    """Return the signed volume between each part's triangles and a point."""
    corner = points[faces[:, 0]] - (middle if len(middle) == 1 else middle[part])
    return (
        np.bincount(part, sum(n * x for n, x in zip(normal, corner.T, strict=True)), len(middle))
        / 6.0
    )
