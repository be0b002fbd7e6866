"""Graded meshes: one mesh at several levels of detail, each part as coarse as its blur allows.

A vertex of full detail is replaced by the vertex of a coarser level that it was merged into, a
triangle by that of its three corners' replacements. As each vertex has one replacement, and all
vertices at one place get replacements at one place, no cracks open where levels meet. A place of a
level is used only if all vertices that were merged into it are blurred enough: levels then meet
along the outlines of merged regions, without folds across them.

The blur that a place needs does not depend on the view. The triangles round it must be smaller than
the blur. Colours are interpolated linearly over a triangle, so the difference of the colour at a
corner from its surroundings is spread over the triangle's area, and must be faint in the area of
the blur. Displacements by a level, of textures above all, must be small in the blur, too.
"""

import numpy as np

from ...snapshot.content import MeshSnapshot, next_uid
from .level_surface import weld
from .mesh_levels import slots_of, surviving

# Largest difference of a vertex colour from its neighbours where triangles are as large as the
# blur; more in proportion where they are smaller. On dragons with baked highlights, where half of
# the triangles of the dragon in focus are saved, grading costs 0.0002 of the SSIM; twice this value
# costs 0.0005 and saves next to nothing more.
_FAINT = 0.0225
# Number of vertices from which the share of triangles that is left is estimated.
_PROBES = 4096


class MergeTree:
    """The merging of a mesh' vertices from level to level; independent of the view.

    Parameters
    ----------
    mesh : MeshSnapshot
        Full detail.
    levels : sequence of MeshLevel
        Its levels of detail, from 1 up; at least one.

    Attributes
    ----------
    probes : ndarray of shape (K,)
        Vertices of full detail that `share` looks at.
    """

    def __init__(self, mesh, levels):
        self._meshes = (mesh, *levels)
        self._merged = [level.merged for level in levels]
        self._places = [*(level.places for level in levels), weld(levels[-1].positions)]
        self._parents = []
        for number, merged in enumerate(self._merged):
            parents = np.full(_count(self._places[number]), -1, np.int32)
            above = self._places[number + 1][np.maximum(merged, 0)]
            parents[self._places[number]] = np.where(merged >= 0, above, -1)
            self._parents.append(parents)
        self._needs = [
            _needed_blur(level, places)
            for level, places in zip(levels, self._places[1:], strict=True)
        ]
        self.probes = np.arange(0, len(mesh.positions), -(-len(mesh.positions) // _PROBES))

    def share(self, blur):
        """Estimate how many triangles `grade` leaves, over those of full detail.

        Parameters
        ----------
        blur : ndarray of shape (K,)
            As for `grade`, at the probes.

        Returns
        -------
        float
        """
        places = self._places[0][self.probes]
        level = np.zeros(len(places))
        for number, (parents, needs) in enumerate(zip(self._parents, self._needs, strict=True)):
            places = np.where(places >= 0, parents[places], -1)
            level[(places >= 0) & (needs[places] <= blur)] = number + 1
        return float(np.exp2(-level).mean()) if len(level) else 1.0

    def grade(self, blur):
        """Make the mesh with every part as coarse as it may be.

        Parameters
        ----------
        blur : ndarray of shape (V,)
            Largest area of triangles at each vertex of full detail, in the space of the mesh; 0 in
            focus. Vertices at one place have the same.

        Returns
        -------
        MeshSnapshot
            Graded mesh: the vertices that its triangles use, with all attributes.
        """
        allowed = self._allowed(blur)
        deepest = len(allowed)
        mesh = self._meshes[0]
        triangles = self._vertices(allowed)[mesh.triangles]
        # Triangles without merged corners cannot have become duplicates.
        moved = (triangles >= len(mesh.positions)).any(axis=1)
        changed = np.flatnonzero(moved)
        places = self._numbered_places(deepest)[triangles[changed]]
        stays = surviving(self._places[0][mesh.triangles[changed]], places)
        kept = ~moved
        kept[changed[stays]] = True
        kept = np.flatnonzero(kept)
        return self._compact(triangles[kept], slots_of(mesh.slots, kept), deepest)

    def _allowed(self, blur):
        """Return, for each level from 1 up, which of its places are used or merged further."""
        least = np.zeros(_count(self._places[0]))
        least[self._places[0]] = blur
        allowed = []
        for parents, needs in zip(self._parents, self._needs, strict=True):
            merges = parents >= 0
            following = np.full(len(needs), np.inf)
            np.minimum.at(following, parents[merges], least[merges])
            allowed.append(needs <= following)
            least = following
        for number in range(len(allowed) - 1, 0, -1):
            parents = self._parents[number]
            merges = parents >= 0
            allowed[number - 1][merges] |= allowed[number][parents[merges]]
        while allowed and not allowed[-1].any():
            allowed.pop()
        return allowed

    def _vertices(self, allowed):
        """Return the replacement of each vertex of full detail, numbered through all levels."""
        counts = [len(mesh.positions) for mesh in self._meshes]
        firsts = np.cumsum([0, *counts])
        vertex_of = None
        for number in range(len(allowed), -1, -1):
            own = np.arange(firsts[number], firsts[number + 1], dtype=np.int32)
            if vertex_of is not None:
                merged = self._merged[number]
                rises = merged >= 0
                rises &= allowed[number][self._places[number + 1][np.maximum(merged, 0)]]
                own[rises] = vertex_of[merged[rises]]
            vertex_of = own
        return vertex_of

    def _numbered_places(self, deepest):
        """Return the places of all vertices, numbered through all levels."""
        parts, first = [], 0
        for places in self._places[: deepest + 1]:
            parts.append(places + np.int32(first))
            first += _count(places)
        return np.concatenate(parts)

    def _compact(self, triangles, slots, deepest):
        meshes = self._meshes[: deepest + 1]
        used = np.zeros(sum(len(mesh.positions) for mesh in meshes), bool)
        used[triangles.ravel()] = True
        number = np.cumsum(used, dtype=np.int32) - 1
        parts, first = [], 0
        for mesh in meshes:
            parts.append((mesh, np.flatnonzero(used[first : first + len(mesh.positions)])))
            first += len(mesh.positions)
        whole = meshes[0]
        return MeshSnapshot(
            next_uid(),
            whole.name,
            np.concatenate([mesh.positions[kept] for mesh, kept in parts]),
            number[triangles],
            slots,
            {
                key: np.concatenate([mesh.attributes[key][kept] for mesh, kept in parts])
                for key in whole.attributes
            },
        )


def _count(numbers):
    return int(numbers.max(initial=-1)) + 1


def _needed_blur(mesh, places):
    """Return the area that must be blurred at each place of a level, in the space of the mesh."""
    count = _count(places)
    corners = places[mesh.triangles].T
    uses = np.maximum(sum(np.bincount(corner, minlength=count) for corner in corners), 1)
    a, b, c = (mesh.positions[corner] for corner in mesh.triangles.T)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
    areas = sum(np.bincount(corner, area, count) for corner in corners) / uses
    contrast = np.zeros(count)
    for key, values in mesh.attributes.items():
        if key.startswith("color:"):
            for channel in values[:, :3].T:
                np.maximum(contrast, _standing_out(channel, places, corners, uses), out=contrast)
    # Displaced textures need more blur than the mean of the places; on average half of a triangle's
    # area is seen.
    moves = np.pi / 2.0 * mesh.errors.blur_of_moves**2
    return areas * np.maximum(contrast / _FAINT, max(moves / max(mesh.triangle_area, 1e-300), 1.0))


def _standing_out(values, places, corners, uses):
    """Return the difference of each place's value from the mean of its neighbours."""
    own = np.zeros(len(uses))
    # One side of a seam is used for all.
    own[places] = values
    around = own[corners]
    whole = around.sum(axis=0)
    others = sum(
        np.bincount(corner, whole - value, len(uses))
        for corner, value in zip(corners, around, strict=True)
    )
    return np.abs(own - others / (2.0 * uses))
