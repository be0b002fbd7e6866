"""Splitting the vertices of a mesh where its corners' attributes differ.

A graphics device knows one value of each attribute a vertex; Blender stores some attributes (UVs,
split normals, colours) a face corner. A vertex is split only where its corners' values differ,
compared bit by bit.
"""

from dataclasses import dataclass

import numpy as np

# Odd multipliers of splitmix64 (Steele, Lea, Flood, OOPSLA 2014): they spread nearby bit patterns.
_MIX_A = np.uint64(0xBF58476D1CE4E5B9)
_MIX_B = np.uint64(0x94D049BB133111EB)
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


@dataclass(frozen=True, eq=False)
class VertexSplit:
    """The vertices of a mesh after splitting.

    Parameters
    ----------
    vertices, corners : ndarray of shape (W,)
        int32; the old vertex and a corner that each new vertex takes its values from. Without
        corner values there are no corners.
    index : ndarray of shape (C,)
        int32; each corner's new vertex.
    unsplit : bool
        The new vertices are the old ones.
    """

    vertices: np.ndarray
    corners: np.ndarray
    index: np.ndarray
    unsplit: bool = False

    def of_vertices(self, values):
        """Return per-vertex values for the new vertices; unsplit ones are not copied."""
        return values if self.unsplit else np.take(values, self.vertices, axis=0)

    def of_corners(self, values):
        """Return per-corner values for the new vertices."""
        return np.take(values, self.corners, axis=0)


def split_vertices(corner_vertices, vertex_count, corner_values=()):
    """Find the fewest vertices that carry every corner's values.

    The old vertices come first and keep their numbers, also those without corners.

    Parameters
    ----------
    corner_vertices : ndarray of shape (C,)
        int32.
    vertex_count : int
    corner_values : sequence of ndarray of shape (C, k)
        float32.

    Returns
    -------
    VertexSplit
    """
    count = len(corner_vertices)
    vertices = np.arange(vertex_count, dtype=np.int32)
    if not corner_values:
        nowhere = np.empty(0, np.int32)
        return VertexSplit(vertices, nowhere, corner_vertices, unsplit=True)
    first = np.zeros(vertex_count, np.int32)
    # Written from the back, so that a vertex's first corner is the one that stays.
    first[corner_vertices[::-1]] = np.arange(count - 1, -1, -1, dtype=np.int32)
    if count == 0:
        return VertexSplit(vertices, first, corner_vertices, unsplit=True)
    bits = [np.ascontiguousarray(values, np.float32).view(np.int32) for values in corner_values]
    representative = np.take(first, corner_vertices)
    differs = np.zeros(count, bool)
    for column in bits:
        for k in range(column.shape[1]):
            component = np.ascontiguousarray(column[:, k])
            differs |= component != np.take(component, representative)
    extra = np.flatnonzero(differs).astype(np.int32)
    if len(extra) == 0:
        return VertexSplit(vertices, first, corner_vertices, unsplit=True)
    unique, inverse = _unique_rows(corner_vertices, bits, extra)
    index = corner_vertices.copy()
    index[extra] = vertex_count + inverse
    return VertexSplit(
        vertices=np.concatenate([vertices, np.take(corner_vertices, unique)]),
        corners=np.concatenate([first, unique]),
        index=index,
    )


def split_all(corner_vertices):
    """Give every corner a vertex of its own, as flat shading needs.

    Parameters
    ----------
    corner_vertices : ndarray of shape (C,)
        int32.

    Returns
    -------
    VertexSplit
    """
    corners = np.arange(len(corner_vertices), dtype=np.int32)
    return VertexSplit(corner_vertices, corners, corners)


def _unique_rows(corner_vertices, bits, rows):
    """Deduplicate corners: return the unique ones, and the index of each of `rows` among them.

    Rows are sorted by a hash and neighbours compared in full, so equal hashes of different rows
    can cost a vertex too many but never a wrong value.
    """
    columns = [np.take(corner_vertices, rows)]
    for column in bits:
        columns.extend(np.take(column[:, k], rows) for k in range(column.shape[1]))
    hashes = np.zeros(len(rows), np.uint64)
    for column in columns:
        hashes ^= column.astype(np.uint32)
        hashes += _GOLDEN
        hashes *= _MIX_A
        hashes ^= hashes >> np.uint64(29)
        hashes *= _MIX_B
        hashes ^= hashes >> np.uint64(32)
    order = np.argsort(hashes, kind="stable")
    starts = np.zeros(len(rows), bool)
    starts[0] = True
    for column in columns:
        ordered = np.take(column, order)
        starts[1:] |= ordered[1:] != ordered[:-1]
    inverse = np.empty(len(rows), np.int32)
    inverse[order] = np.cumsum(starts, dtype=np.int32) - 1
    return np.take(rows, order[starts]), inverse
