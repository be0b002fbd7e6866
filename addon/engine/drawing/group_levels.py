"""The levels of detail that a content's groups of instances may be drawn at."""

import numpy as np

from ...levels.bent_attributes import bent_attributes
from ...levels.choosing import (
    LEAST_GRADED_TRIANGLES,
    allowances,
    allowed_levels,
    blur_for_levels,
    choose_levels,
)


class GroupLevels:
    """Which levels each group has, and those that a frame draws its instances at.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
        Updated to it.

    Attributes
    ----------
    triangles : list of list of int
        Of each group, the triangles of its levels, from full detail on.
    table : ndarray of shape (G, L)
        The same.
    """

    def __init__(self, content, buffers):
        self._content = content
        self.triangles, self._blurs = [], []
        bent = {}
        for group in content.groups:
            meshes = buffers.level_meshes(content.meshes[group.mesh])
            if len(meshes) > 1:
                for uid in group.materials:
                    if uid not in bent:
                        bent[uid] = bent_attributes(content.materials[uid].graph)
                keys = frozenset().union(*(bent[uid] for uid in group.materials))
                meshes = meshes[: 1 + buffers.unbent_levels(group.mesh, keys)]
            self.triangles.append([len(mesh.triangles) for mesh in meshes])
            self._blurs.append(blur_for_levels(*meshes))
        # Beyond a group's own levels it is never asked.
        self.table = np.zeros((len(self.triangles), max(map(len, self.triangles), default=1)), int)
        for row, counts in zip(self.table, self.triangles, strict=True):
            row[: len(counts)] = counts

    def gradable(self):
        """Return which groups have so many triangles that graded meshes may pay, shape (G,)."""
        several = np.array([len(counts) > 1 for counts in self.triangles], bool)
        return several & (self.table[:, 0] >= LEAST_GRADED_TRIANGLES)

    def deepest(self, row):
        """Return the coarsest level of the instance in a row of the table."""
        return len(self.triangles[self._content.group_of[row]]) - 1

    def choose(self, seen, plan):
        """Return the level of each instance in a frame.

        Parameters
        ----------
        seen : levels.choosing.Extents
        plan : FramePlan

        Returns
        -------
        ndarray of shape (I,)
        """
        group_of = self._content.group_of
        deepest = np.array([len(counts) - 1 for counts in self.triangles], int)
        if plan.level_bias is None or not deepest.any():
            return np.zeros(len(group_of))
        full = self.table[:, 0].astype(float)[group_of]
        bias = plan.level_bias + allowances(self._content, plan)
        chosen = choose_levels(seen, full, plan, bias)
        for number, group in enumerate(self._content.groups):
            rows = slice(group.first, group.first + group.count)
            chosen[rows] = allowed_levels(chosen[rows], self._blurs[number])
        return np.minimum(chosen, deepest[group_of])
