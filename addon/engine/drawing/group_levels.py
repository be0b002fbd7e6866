"""The levels of detail that a content's groups of instances may be drawn at."""

import numpy as np

from ...levels.bent_attributes import bent_attributes
from ...levels.choosing import allowances, allowed_levels, blur_for_levels, choose_levels


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
    """

    def __init__(self, content, buffers):
        self._content = content
        self.triangles, self._blurs = [], []
        self._group_of = np.zeros(len(content.instances.world), np.int64)
        bent = {}
        for number, group in enumerate(content.groups):
            self._group_of[group.first : group.first + group.count] = number
            meshes = buffers.level_meshes(content.meshes[group.mesh])
            if len(meshes) > 1:
                for uid in group.materials:
                    if uid not in bent:
                        bent[uid] = bent_attributes(content.materials[uid].graph)
                keys = frozenset().union(*(bent[uid] for uid in group.materials))
                meshes = meshes[: 1 + buffers.unbent_levels(group.mesh, keys)]
            self.triangles.append([len(mesh.triangles) for mesh in meshes])
            self._blurs.append(blur_for_levels(*meshes))

    def deepest(self, row):
        """Return the coarsest level of the instance in a row of the table."""
        return len(self.triangles[self._group_of[row]]) - 1

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
        deepest = np.array([len(counts) - 1 for counts in self.triangles], int)[self._group_of]
        if plan.level_bias is None or not deepest.any():
            return np.zeros(len(deepest))
        full = np.array([counts[0] for counts in self.triangles], float)[self._group_of]
        bias = plan.level_bias + allowances(self._content, plan)
        chosen = choose_levels(seen, full, plan, bias)
        for number, group in enumerate(self._content.groups):
            rows = slice(group.first, group.first + group.count)
            chosen[rows] = allowed_levels(chosen[rows], self._blurs[number])
        return np.minimum(chosen, deepest)
