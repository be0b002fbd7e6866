"""One step from a level of detail to the next: correspondence of places and vertices.

It gathers what the other modules of this room need to know about both levels.
"""

from functools import cached_property

import numpy as np

from .level_parts import find_pairs, following_parts, grown
from .level_places import merged_places
from .level_projection import Projection, vertex_areas
from .level_shape import Shape


class Step:
    """The step from a level to the next.

    Parameters
    ----------
    mesh : MeshSnapshot
        The level before.
    surface : Surface
        Of that level.
    groups : ndarray of shape (P,)
        The new place of each old one.
    vertex_of : ndarray of shape (V,)
        New vertex that each old one was merged into, -1 where it is gone.
    vertex_places : ndarray of shape (W,)
        The new place of each new vertex.
    triangles : ndarray of shape (T, 3)
        The new level's.

    Attributes
    ----------
    pairs : Pairs or None
    parts : ndarray of shape (G,)
        Of the new places.
    pair_moves : float
        Squared displacements of the centres of merged parts, weighted by twice their areas; with
        pairs only.
    points : ndarray of shape (G, 3)
        The new places.
    """

    def __init__(self, mesh, surface, groups, vertex_of, vertex_places, triangles):
        self.mesh, self.surface, self.groups = mesh, surface, groups
        self.vertex_of, self.vertex_places, self.triangles = vertex_of, vertex_places, triangles
        self.pairs = find_pairs(surface, groups)
        self.parts = following_parts(surface, groups, self.pairs)
        self.whole = np.arange(surface.part_count)
        if self.pairs is not None:
            self.whole[self.pairs.goes] = self.pairs.stays
        points = merged_places(surface, groups)
        fixed = np.zeros(len(points), bool)
        if self.pairs is not None:
            places, where, self.pair_moves = grown(surface, self.pairs)
            points[groups[places]] = where
            fixed[groups[places]] = True
        faces = vertex_places[triangles]
        shape = Shape(surface, groups, self.parts, self.whole, faces, fixed)
        self.points = shape.filled(shape.outlined(points))

    @cached_property
    def old_areas(self):
        """Of the old vertices, shape (4, V); see `vertex_areas`."""
        mesh = self.mesh
        return vertex_areas(self.surface.normal, mesh.triangles, len(mesh.positions))

    @cached_property
    def projection(self):
        """The old vertices on the new triangles."""
        return Projection(
            self.mesh.positions,
            self.old_areas,
            self.vertex_of,
            np.float32(self.points[self.vertex_places]),
            self.triangles,
        )

    def part_of_old(self):
        """Return the part of each old vertex, shape (V,); merged parts count as one."""
        return self.whole[self.surface.parts][self.surface.places]

    def part_of_new(self):
        """Return the part of each new vertex, shape (W,)."""
        return self.parts[self.vertex_places]
