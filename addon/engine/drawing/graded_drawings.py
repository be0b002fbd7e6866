"""Graded meshes of large objects that are partly in focus: coarser only where they are blurred.

The level of detail of such an instance is 0, as a part of it is in focus. A graded mesh, whose
parts are each as coarse as their own circle of confusion allows, is made for one view and depth of
field, and kept while these stay.
"""

from dataclasses import dataclass

import numpy as np

from ...device import context
from ...device.geometry import MeshBuffers
from ...levels.choosing import LEAST_ALLOWANCE, blurred_area

# Seconds for each triangle of full detail: to make and upload a graded mesh, on a core at 2 to
# 3 GHz; to draw one, on a graphics device that draws 2 triangles a nanosecond, and with software
# OpenGL. So a graded mesh of half the triangles pays off on a graphics device after 600 lens
# samples, in software after the first.
_MAKING = 1.5e-7
_DRAWING = 5e-10
_DRAWING_IN_SOFTWARE = 3e-7
# A progressive picture (a viewport's) may be given up any time: it is drawn at full detail until
# its samples have cost as much as making the graded mesh, but for so many samples at least.
_LEAST_SAMPLES_BEFORE = 4
# Assumed share of triangles that are left, where estimating it would take too long.
_USUAL_SHARE = 0.5
# Most bytes of all graded meshes on the device, as estimated.
_BYTES = 512 << 20


@dataclass(frozen=True, eq=False)
class _Candidate:
    """An instance that may be drawn graded.

    Parameters
    ----------
    mesh : MeshSnapshot
    world : ndarray of shape (4, 4)
        Object to world space.
    deepest : int
        Coarsest level that its parts may have.
    depth : ndarray of shape (4,)
        Depth as a linear function of object space: a factor for each coordinate, and a constant.
    """

    mesh: object
    world: np.ndarray
    deepest: int
    depth: np.ndarray


class GradedDrawings:
    """The instances that a frame draws with graded meshes, and those meshes on the device.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
    made : dict
        Graded meshes of earlier frames by their keys; changed by this object.

    Attributes
    ----------
    rows : dict of int to int
        By row of the instance table, the lens sample from which on it is drawn graded.
    """

    def __init__(self, content, buffers, made):
        self._content = content
        self._buffers = buffers
        self._made = made
        self._drawing = _DRAWING_IN_SOFTWARE if context.is_software() else _DRAWING
        self._candidates, self._shares, self._keys = {}, {}, {}
        self.rows = {}

    def find_among(self, full, deepest_of, group_of, plan):
        """Begin a frame: find them among the instances that may be graded.

        Parameters
        ----------
        full : ndarray of shape (I,)
            bool: rows of the instance table that are drawn at level 0 and not divided, and that
            `GroupLevels.gradable` allows.
        deepest_of : callable
            From a row to the coarsest level that its parts may have.
        group_of : ndarray of shape (I,)
        plan : FramePlan
        """
        wanted = plan.level_bias is not None and plan.coc_scale != 0.0
        rows = np.flatnonzero(full & wanted)
        if plan.bokeh:
            # Not graded where the light varies over the surface: highlights are found at full
            # detail.
            rows = rows[~np.isin(group_of[rows], list(plan.bokeh.uneven))]
        self.find({int(row): deepest_of(row) for row in rows}, group_of, plan)

    def slack(self, group, triangles):
        """Return how far a graded mesh may be from the true surface, in its units.

        Parameters
        ----------
        group : int
        triangles : sequence of int
            Of its level 0 as it is drawn, and of the others.
        """
        mesh = self._content.meshes[self._content.groups[group].mesh]
        count = max(triangles[0], 1)
        # Its coarsest parts are larger than the mean.
        return 2.0 * float(np.sqrt(mesh.triangle_area * len(mesh.triangles) / count))

    def find(self, depths, group_of, plan):
        """Begin a frame: find the instances whose graded mesh would save triangles.

        Parameters
        ----------
        depths : dict of int to int
            By row of the instance table that is drawn at level 0, and that `GroupLevels.gradable`
            allows, the coarsest level that its parts may have.
        group_of : ndarray of shape (I,)
        plan : FramePlan
        """
        self._plan = plan
        self._candidates, self._shares, self._keys = {}, {}, {}
        self.rows = {}
        for row, deepest in depths.items():
            mesh = self._content.meshes[self._content.groups[group_of[row]].mesh]
            levels = self._buffers.levels.get(mesh.uid)
            count = len(mesh.triangles)
            if not levels or deepest == 0 or not self._pays(count, 0.0, plan.samples):
                continue
            world = self._content.instances.world[row].astype(np.float64)
            found = _Candidate(mesh, world, deepest, -(plan.view[2] @ world))
            share = self._share(found)
            if self._pays(count, share, plan.samples):
                self._candidates[row] = found
                self._shares[row] = share
                self._keys[row] = self._key(found, levels)

    @property
    def candidates(self):
        """Rows that may be drawn graded, in a list."""
        return list(self._shares)

    def triangles(self, row, counts):
        """Return about how many triangles an instance is drawn with, by level of detail."""
        share = self._shares.get(row)
        return counts if share is None else [int(counts[0] * share), *counts[1:]]

    def settle(self, drawings):
        """Decide which candidates are drawn graded.

        Parameters
        ----------
        drawings : callable
            From a row and a number of lens samples to the number of times that it is drawn.
        """
        for key in self._made.keys() - self._keys.values():
            del self._made[key]
        room = _BYTES
        for row, found in self._candidates.items():
            count, share = len(found.mesh.triangles), self._shares[row]
            if self._pays(count, share, drawings(row, self._plan.samples)):
                # Cached meshes of earlier frames must not change which rows are graded, nor from
                # where.
                room -= int(self._buffers.meshes[found.mesh.uid].bytes * share)
                if room < 0:
                    break
                first = 0
                if self._plan.progressive:
                    paid = _MAKING / (self._drawing * (1.0 - share))
                    first = max(_LEAST_SAMPLES_BEFORE, int(np.ceil(paid)))
                self.rows[row] = first

    def mesh(self, row, index):
        """Return the graded mesh of an instance.

        Parameters
        ----------
        row : int
        index : int
            The lens sample.

        Returns
        -------
        MeshBuffers or None
            None where it is drawn at full detail.
        """
        if index < self.rows.get(row, self._plan.samples):
            return None
        key = self._keys[row]
        if key not in self._made:
            found = self._candidates[row]
            tree = self._buffers.merge_tree(found.mesh.uid, found.deepest)
            self._made[key] = MeshBuffers(tree.grade(self._limits(found)))
        return self._made[key]

    @property
    def bytes(self):
        """Bytes that the graded meshes take on the device."""
        return sum(mesh.bytes for mesh in self._made.values())

    def _share(self, found):
        if self._plan.progressive:
            return _USUAL_SHARE
        tree = self._buffers.merge_tree(found.mesh.uid, found.deepest)
        return tree.share(self._limits(found, tree.probes))

    def _limits(self, found, vertices=slice(None)):
        depth = found.mesh.positions[vertices] @ found.depth[:3] + found.depth[3]
        bias = self._plan.level_bias + LEAST_ALLOWANCE
        return blurred_area(depth, found.world, self._plan, bias)

    def _key(self, found, levels):
        """Return the cache key of a graded mesh; levels that were made again are other objects."""
        plan = self._plan
        lens = (plan.focus_distance, plan.coc_scale, *plan.lens_extent.tolist())
        if plan.chromatic:
            lens += tuple(plan.chromatic.overall().inverse_focus.tolist())
        shown = (plan.projection[1, 1], plan.height, plan.orthographic, plan.level_bias)
        place = (found.depth.tobytes(), found.world[:3, :3].tobytes())
        return found.mesh.uid, levels, found.deepest, place, lens, shown

    def _pays(self, triangles, share, drawings):
        saved = drawings * triangles * (1.0 - share)
        return saved * self._drawing > triangles * _MAKING
