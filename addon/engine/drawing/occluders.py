"""Occluders of highlights: clusters of opaque triangles in a bounding volume hierarchy.

The cone of rays from a highlight to the lens is narrow: it meets few triangles of a large mesh. So
every mesh, at every level of detail, is cut into clusters of neighbouring triangles, and their
bounding boxes, those of eight boxes each, and so on make a tree. The parts of the scene (one
surface of one instance) have such a tree, too. A cone is tested from the top of both, finds its
clusters in a few steps, and only these are drawn.

Neighbours are triangles that are close on a Z-order curve.
"""

from dataclasses import dataclass

import numpy as np

from ...device.textures import texture_2d
from ...passes.visibility.cones import CLUSTER, CLUSTERS_PER_ROW, PART_TEXELS
from ...passes.visibility.prefix_sums import COLUMNS

# Boxes below a box.
BRANCHES = 8


@dataclass(frozen=True, eq=False)
class Shape:
    """The triangles of one material slot of a mesh, cut into clusters.

    Parameters
    ----------
    corners : ndarray of shape (C, 3 CLUSTER, 3)
        float32; the last cluster is padded with degenerate triangles.
    boxes : ndarray of shape (B, 2, 3)
        float32; bounding boxes of the clusters, then of eight of these each, and so on.
    area : float
        Mean area of a triangle.
    """

    corners: np.ndarray
    boxes: np.ndarray
    area: float


def z_order(points):
    """Return the order of points along a Z-order curve.

    Parameters
    ----------
    points : ndarray of shape (N, 3)

    Returns
    -------
    ndarray of shape (N,)
        int.
    """
    low = points.min(axis=0)
    extent = max(float((points.max(axis=0) - low).max()), 1e-30)
    cells = np.clip((points - low) / extent * 1024.0, 0.0, 1023.0).astype(np.uint32)
    code = np.zeros(len(points), np.uint32)
    for axis in range(3):
        bits = cells[:, axis]
        for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
            bits = (bits | (bits << np.uint32(shift))) & np.uint32(mask)
        code |= bits << np.uint32(axis)
    return np.argsort(code, kind="stable")


def box_tree(boxes):
    """Return boxes and, behind them, the bounding boxes of eight each, and so on to the root.

    Parameters
    ----------
    boxes : ndarray of shape (N, 2, 3)

    Returns
    -------
    ndarray of shape (B, 2, 3)
    """
    levels = [boxes]
    while len(levels[-1]) > BRANCHES:
        below = levels[-1]
        starts = np.arange(0, len(below), BRANCHES)
        levels.append(
            np.stack(
                [
                    np.minimum.reduceat(below[:, 0], starts),
                    np.maximum.reduceat(below[:, 1], starts),
                ],
                axis=1,
            )
        )
    return np.concatenate(levels)


def depth_first(boxes, leaves):
    """Lay out a tree of boxes depth first, so that it is walked without a stack.

    Parameters
    ----------
    boxes : ndarray of shape (B, 2, 3)
        Of `box_tree`.
    leaves : int
        How many boxes it was made from.

    Returns
    -------
    ndarray of shape (B, 2, 4)
        Each box before those inside it. Fourth values: number of boxes to skip where the box is not
        met; number of a leaf, otherwise -1.
    """
    numbers, places = [leaves], [0]
    while numbers[-1] > BRANCHES:
        places.append(places[-1] + numbers[-1])
        numbers.append(-(-numbers[-1] // BRANCHES))
    sizes = [np.ones(leaves, int)]
    for _ in numbers[1:]:
        starts = np.arange(0, len(sizes[-1]), BRANCHES)
        sizes.append(1 + np.add.reduceat(sizes[-1], starts))
    laid = np.zeros((len(boxes), 2, 4), np.float32)
    above = None
    for level in range(len(numbers) - 1, -1, -1):
        size = sizes[level]
        before = np.cumsum(size) - size
        if above is None:
            order = before
        else:
            parent = np.arange(len(size)) // BRANCHES
            order = above[parent] + 1 + before - before[parent * BRANCHES]
        laid[order, :, :3] = boxes[places[level] : places[level] + numbers[level]]
        laid[order, 0, 3] = size
        laid[order, 1, 3] = np.arange(leaves) if level == 0 else -1.0
        above = order
    return laid


def cut(positions, triangles):
    """Cut triangles into clusters.

    Parameters
    ----------
    positions : ndarray of shape (V, 3)
    triangles : ndarray of shape (T, 3)
        At least one.

    Returns
    -------
    Shape
    """
    corners = positions[triangles].astype(np.float32)
    corners = corners[z_order(corners.mean(axis=1))]
    sides = corners[:, 1:].astype(np.float64) - corners[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).mean()
    corners = corners.reshape(-1, 3)
    count = -(-len(triangles) // CLUSTER)
    filled = np.repeat(corners[-1:], count * CLUSTER * 3, axis=0)
    filled[: len(corners)] = corners
    filled = filled.reshape(count, CLUSTER * 3, 3)
    boxes = np.stack([filled.min(axis=1), filled.max(axis=1)], axis=1)
    return Shape(filled, box_tree(boxes), float(area))


class ShapeCache:
    """Shapes of meshes, made once, and their tables on the device."""

    def __init__(self):
        self._shapes = {}
        self._tables = None

    def shape(self, mesh, slot):
        """Return the shape of a mesh' material slot; None if it has no triangles.

        Parameters
        ----------
        mesh : MeshSnapshot
        slot : int
        """
        key = (mesh.uid, slot)
        if key not in self._shapes:
            ranges = [(first, count) for number, first, count in mesh.slots if number == slot]
            triangles = [mesh.triangles[first : first + count] for first, count in ranges]
            triangles = np.concatenate(triangles) if triangles else np.empty((0, 3), int)
            self._shapes[key] = cut(mesh.positions, triangles) if len(triangles) else None
        return self._shapes[key]

    def tables(self, shapes):
        """Return the `ShapeTables` of shapes; those of the last call if they are the same."""
        if self._tables is None or not self._tables.holds(shapes):
            self._tables = None
            self._tables = ShapeTables(shapes)
        return self._tables

    def keep(self, uids):
        """Forget all meshes but those with these uids."""
        kept = {key: shape for key, shape in self._shapes.items() if key[0] in uids}
        if len(kept) < len(self._shapes):
            self._tables = None
        self._shapes = kept


@dataclass(frozen=True, eq=False)
class Part:
    """One material slot of one mesh, with all instances of a group of the content.

    Parameters
    ----------
    first, count : int
        Rows of the instance table.
    shapes : tuple of Shape
        By level of detail.
    """

    first: int
    count: int
    shapes: tuple[Shape, ...]


class ShapeTables:
    """The clusters of shapes on the device; kept as long as no mesh changes.

    Parameters
    ----------
    shapes : sequence of Shape

    Attributes
    ----------
    shapes : tuple of Shape
    corners : GPUTexture
        Corners of the triangles, CLUSTERS_PER_ROW clusters a row.
    boxes : GPUTexture
        Two texels a box, lower and upper corner in object space, as `depth_first` lays them out:
        the trees of all shapes.
    table : GPUTexture
        One texel a shape: first box, number of boxes, first cluster.
    bytes : int
    """

    def __init__(self, shapes):
        self.shapes = tuple(shapes)
        clusters = sum(len(s.corners) for s in self.shapes)
        rows = -(-max(clusters, 1) // CLUSTERS_PER_ROW)
        corners = np.zeros((rows * CLUSTERS_PER_ROW, CLUSTER * 3, 4), np.float32)
        table = np.zeros((max(len(self.shapes), 1), 4))
        box = cluster = 0
        for number, shape in enumerate(self.shapes):
            end = cluster + len(shape.corners)
            corners[cluster:end, :, :3] = shape.corners
            table[number, :3] = box, len(shape.boxes), cluster
            box += len(shape.boxes)
            cluster = end
        boxes = [depth_first(s.boxes, len(s.corners)).reshape(-1, 4) for s in self.shapes]
        self.corners = texture_2d(corners.reshape(rows, -1, 4))
        self.boxes = _table(np.concatenate(boxes) if boxes else np.zeros((2, 4)))
        self.table = _table(table)
        self.bytes = _bytes_of(self.corners, self.boxes, self.table)

    def holds(self, shapes):
        """Return whether these are its shapes."""
        return len(shapes) == len(self.shapes) and all(
            a is b for a, b in zip(shapes, self.shapes, strict=True)
        )


class Occluders:
    """The parts of a scene and their clusters on the device.

    Parameters
    ----------
    parts : sequence of Part
    world : ndarray of shape (I, 4, 4)
        Object to world, of the instance table.
    cache : ShapeCache, optional
        Keeps the clusters for the next occluders of the same shapes.

    Attributes
    ----------
    corners, boxes, shapes : GPUTexture
        Of `ShapeTables`.
    part_boxes : GPUTexture
        Two texels a box, in world space, as in `ShapeTables`: the tree of the parts.
    parts : GPUTexture
        PART_TEXELS texels a part: row of the instance table, first shape, number of levels, area of
        a triangle at full detail in world space; then the largest coordinates in object space.
    count, part_boxes_count : int
        Number of parts, and of the boxes of their tree.
    bytes : int
    """

    def __init__(self, parts, world, cache=None):
        tables = occluder_tables(parts, world.astype(np.float64))
        shapes = cache.tables(tables.shapes) if cache else ShapeTables(tables.shapes)
        self.count = len(tables.parts)
        self.part_boxes_count = len(tables.boxes) if self.count else 0
        self.corners, self.boxes, self.shapes = shapes.corners, shapes.boxes, shapes.table
        self.part_boxes = _table(depth_first(tables.boxes, max(self.count, 1)).reshape(-1, 4))
        self.parts = _table(tables.parts.reshape(-1, 4))
        self.bytes = shapes.bytes + _bytes_of(self.part_boxes, self.parts)


@dataclass(frozen=True, eq=False)
class OccluderTables:
    """The arrays behind `Occluders`; see there.

    Parameters
    ----------
    boxes : ndarray of shape (B, 2, 3)
        The tree of the parts.
    parts : ndarray of shape (P, PART_TEXELS, 4)
    shapes : list of Shape
    """

    boxes: np.ndarray
    parts: np.ndarray
    shapes: list


def occluder_tables(parts, world):
    """Lay out the parts of a scene.

    Parameters
    ----------
    parts : sequence of Part
    world : ndarray of shape (I, 4, 4)

    Returns
    -------
    OccluderTables
    """
    part_boxes, records = [], []
    shapes, numbers = [], {}
    for part in parts:
        first = numbers.get(id(part.shapes))
        if first is None:
            first = numbers[id(part.shapes)] = len(shapes)
            shapes.extend(part.shapes)
        full = part.shapes[0]
        matrices = world[part.first : part.first + part.count]
        linear = matrices[:, :3, :3]
        boxes = full.boxes.astype(np.float64)
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        center = linear @ ((low + high) / 2) + matrices[:, :3, 3]
        reach = np.abs(linear) @ ((high - low) / 2)
        part_boxes.append(np.stack([center - reach, center + reach], axis=1))
        record = np.zeros((part.count, PART_TEXELS, 4))
        record[:, 0, 0] = part.first + np.arange(part.count)
        record[:, 0, 1] = first
        record[:, 0, 2] = len(part.shapes)
        record[:, 0, 3] = full.area * np.cbrt(np.abs(np.linalg.det(linear))) ** 2
        record[:, 1, :3] = np.maximum(np.abs(low), np.abs(high))
        records.append(record)
    if not records:
        return OccluderTables(np.zeros((1, 2, 3)), np.zeros((0, PART_TEXELS, 4)), [])
    part_boxes, records = np.concatenate(part_boxes), np.concatenate(records)
    order = z_order(part_boxes.mean(axis=1))
    tree = box_tree(part_boxes[order])
    # Margin: the device tests in single precision, and no part may fall out of its box.
    slack = 1e-6 * np.abs(tree).max()
    tree = tree + np.array([-slack, slack])[:, None]
    return OccluderTables(tree, records[order], shapes)


def _bytes_of(*textures):
    return sum(16 * t.width * t.height for t in textures)


def _table(texels):
    """Upload rows of up to four numbers, COLUMNS a row of the texture."""
    count = max(len(texels), 1)
    rows = -(-count // COLUMNS)
    table = np.zeros((rows * COLUMNS, 4), np.float32)
    table[: len(texels), : texels.shape[1]] = texels
    return texture_2d(table.reshape(rows, COLUMNS, 4))
