"""Large objects that are partly in focus: drawn at full detail there, coarser where they blur.

Their level of detail is 0, as for everything of which a part is in focus; only what is sent to the
device for it changes. A mesh whose parts are as coarse as their own blur allows is made for one
view and depth of field, and kept while these stay.
"""

from dataclasses import dataclass

import numpy as np

from ...device import context
from ...device.geometry import MeshBuffers
from ...levels.choosing import LEAST_ALLOWANCE, LEAST_GRADED_TRIANGLES, blurred_area

# Seconds a triangle of full detail: to make a graded mesh and bring it to the device, on a core at
# 2 to 3 GHz; to draw, by a graphics device that manages 2 triangles a nanosecond, and by software
# OpenGL. So one that halves the triangles has paid on a graphics device after 600 lens samples, in
# software after the first.
_MAKING = 1.5e-7
_DRAWING = 5e-10
_DRAWING_IN_SOFTWARE = 3e-7
# What may be given up any time, as the picture of a view that moves, is drawn at full detail until
# the samples have cost as much as a graded mesh, but for so many at least.
_LEAST_SAMPLES_BEFORE = 4
# Triangles left, over those of full detail, where finding out would take too long.
_USUAL_SHARE = 0.5
# Of the graded meshes on the device, together, as estimated.
_BYTES = 512 << 20


@dataclass(frozen=True, eq=False)
class _Candidate:
    """An instance that may be drawn graded.

    Parameters
    ----------
    mesh : MeshSnapshot
    world : ndarray of shape (4, 4)
        Object to world space.
    depth : ndarray of shape (4,)
        Depth of a place in object space: a factor for each coordinate, and a constant.
    """

    mesh: object
    world: np.ndarray
    depth: np.ndarray


class GradedDrawings:
    """Which instances are drawn graded in a frame, and their meshes on the device.

    Parameters
    ----------
    content : SceneContent
    buffers : SceneBuffers
    made : dict
        Kept from earlier frames, by what they depend on; changed by this object.

    Attributes
    ----------
    rows : dict of int to int
        Rows of the instance table, and the lens sample from which on each is drawn graded.
    """

    def __init__(self, content, buffers, made):
        self._content = content
        self._buffers = buffers
        self._made = made
        self._drawing = _DRAWING_IN_SOFTWARE if context.is_software() else _DRAWING
        self._candidates, self._shares, self._keys = {}, {}, {}
        self.rows = {}

    def find(self, rows, group_of, plan):
        """Begin a frame: find the instances that would save by being graded.

        Parameters
        ----------
        rows : iterable of int
            Of the instance table: what is drawn at level 0.
        group_of : ndarray of shape (I,)
        plan : FramePlan
        """
        self._plan = plan
        self._candidates, self._shares, self._keys = {}, {}, {}
        self.rows = {}
        for row in rows:
            mesh = self._content.meshes[self._content.groups[group_of[row]].mesh]
            levels = self._buffers.levels.get(mesh.uid)
            count = len(mesh.triangles)
            if (
                count < LEAST_GRADED_TRIANGLES
                or not levels
                or not self._pays(count, 0.0, plan.samples)
            ):
                continue
            world = self._content.instances.world[row].astype(np.float64)
            found = _Candidate(mesh, world, -(plan.view[2] @ world))
            share = self._share(found)
            if self._pays(count, share, plan.samples):
                self._candidates[row] = found
                self._shares[row] = share
                self._keys[row] = self._key(found, levels)

    def triangles(self, row, counts):
        """Return about how many triangles an instance takes, by level of detail."""
        share = self._shares.get(row)
        return counts if share is None else [int(counts[0] * share), *counts[1:]]

    def settle(self, drawings):
        """Decide what is drawn graded.

        Parameters
        ----------
        drawings : callable
            From a row and the number of lens samples to how often it is drawn for them.
        """
        for key in self._made.keys() - self._keys.values():
            del self._made[key]
        room = _BYTES
        for row, found in self._candidates.items():
            count, share = len(found.mesh.triangles), self._shares[row]
            if self._pays(count, share, drawings(row, self._plan.samples)):
                # What is there from an earlier frame changes neither what is graded nor since when.
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
            tree = self._buffers.merge_tree(found.mesh.uid)
            self._made[key] = MeshBuffers(tree.grade(self._limits(found)))
        return self._made[key]

    @property
    def bytes(self):
        """Bytes of the graded meshes on the device."""
        return sum(mesh.bytes for mesh in self._made.values())

    def _share(self, found):
        if self._plan.progressive:
            return _USUAL_SHARE
        tree = self._buffers.merge_tree(found.mesh.uid)
        return tree.share(self._limits(found, tree.probes))

    def _limits(self, found, vertices=slice(None)):
        depth = found.mesh.positions[vertices] @ found.depth[:3] + found.depth[3]
        bias = self._plan.level_bias + LEAST_ALLOWANCE
        return blurred_area(depth, found.world, self._plan, bias)

    def _key(self, found, levels):
        """Return what a graded mesh depends on; levels that were made again are other objects."""
        plan = self._plan
        lens = (plan.focus_distance, plan.coc_scale, *plan.lens_extent.tolist())
        if plan.chromatic:
            lens += tuple(plan.chromatic.overall().inverse_focus.tolist())
        shown = (plan.projection[1, 1], plan.height, plan.orthographic, plan.level_bias)
        place = (found.depth.tobytes(), found.world[:3, :3].tobytes())
        return found.mesh.uid, levels, place, lens, shown

    def _pays(self, triangles, share, drawings):
        saved = drawings * triangles * (1.0 - share)
        return saved * self._drawing > triangles * _MAKING
