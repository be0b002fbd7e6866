"""Large triangles seen through a real lens, divided where its displacement bends across them.

A vertex shader displaces corners; between them a triangle stays flat. Divided meshes are made for
one view, and kept while it stays.
"""

import numpy as np

from ...device.geometry import MeshBuffers
from ...levels.making.divided_mesh import divided_mesh

# Longest edge of a triangle, in widths of a picture of so many pixels: what a lens adds bends
# little across it. How far it bends grows with the square of the edge, and in pixels with their
# number; in another picture an edge is as long as bends as many pixels.
_LONGEST, _PIXELS = 1.0 / 24.0, 480.0
# Width beyond the picture's edges in which triangles are divided, in its sides.
_BEYOND = 0.1
# Depth as which nearer places count: over the nearest of the tables.
_NEAREST = 0.25


class DividedDrawings:
    """The instances that a frame draws with divided triangles, and their meshes on the device.

    Parameters
    ----------
    content : SceneContent

    Attributes
    ----------
    rows : frozenset of int
        Rows of the instance table that are drawn with a divided mesh at full detail.
    """

    def __init__(self, content):
        self._content = content
        self._longest = {}
        self._made = {}
        self.rows = frozenset()

    def find(self, rows, group_of, nearest, plan):
        """Begin a frame: divide the meshes that need it.

        Parameters
        ----------
        rows : sequence of int
            Rows of the instance table that are drawn at level 0.
        group_of : ndarray of shape (I,)
        nearest : ndarray of shape (I,)
            Least depth of each instance, m.
        plan : FramePlan
            With a `real_lens`; without, nothing is divided.
        """
        self.rows = frozenset()
        if plan.real_lens is None or not len(rows):
            self._made = {}
            return
        content, tables = self._content, plan.real_lens.tables
        low, high = tables.light_grid.low, tables.light_grid.high
        longest = _longest_edge(float((high - low).max()), plan)
        wider = _BEYOND * (high - low)
        bounds = low - wider, high + wider
        least = _NEAREST / tables.largest_vergence
        rows = np.asarray(rows)
        edges = np.array([self._edge_of(content.groups[g].mesh) for g in group_of[rows]])
        worlds = content.instances.world[rows].astype(np.float64)
        scale = np.linalg.norm(worlds[:, :3, :3], ord=2, axis=(1, 2))
        # Twice: an edge also runs aside where it runs in depth.
        large = 2.0 * edges * scale > longest * np.maximum(nearest[rows], least)
        kept, found = {}, []
        for row, world in zip(rows[large].tolist(), worlds[large], strict=True):
            mesh = content.meshes[content.groups[group_of[row]].mesh]
            to_eye = plan.view @ world
            key = (mesh.uid, to_eye.tobytes(), longest, low.tobytes(), high.tobytes(), least)
            made = self._made.get(key)
            if made is None:
                divided = divided_mesh(mesh, to_eye, longest, bounds, least)
                made = False if divided is mesh else MeshBuffers(divided)
            kept[key] = made
            if made:
                found.append((row, made))
        self._made = kept
        self._of_row = dict(found)
        self.rows = frozenset(self._of_row)

    def mesh(self, row):
        """Return the divided mesh of an instance, or None."""
        return self._of_row[row] if row in self.rows else None

    @property
    def bytes(self):
        """Bytes that the divided meshes take on the device."""
        return sum(mesh.bytes for mesh in self._made.values() if mesh)

    def _edge_of(self, uid):
        if uid not in self._longest:
            mesh = self._content.meshes[uid]
            corners = mesh.positions[mesh.triangles].astype(np.float64)
            sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1)
            self._longest[uid] = float(sides.max(initial=0.0))
        return self._longest[uid]


def _longest_edge(side, plan):
    """Return the longest edge as a tangent; `side`: the picture's longer side, the same."""
    pixel = min(
        2.0 / (abs(plan.projection[axis, axis]) * size)
        for axis, size in enumerate((plan.width, plan.height))
    )
    return _LONGEST * side * float(np.sqrt(_PIXELS * pixel / side))
