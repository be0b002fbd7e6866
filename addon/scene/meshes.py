"""Evaluated Blender meshes to `MeshSnapshot`."""

import numpy as np

from ..errors import SnapshotError
from .snapshot import MeshSnapshot, next_uid


def read_mesh(mesh):
    """Copy an evaluated mesh.

    Corner attributes that agree at a vertex stay one vertex; vertices are split only where UVs or
    normals differ.

    Parameters
    ----------
    mesh : bpy.types.Mesh

    Returns
    -------
    MeshSnapshot

    Raises
    ------
    SnapshotError
        If a coordinate is not finite.
    """
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    if len(positions):
        mesh.attributes["position"].data.foreach_get("vector", positions.reshape(-1))
    if not np.isfinite(positions).all():
        bad = int(np.flatnonzero(~np.isfinite(positions).all(axis=1))[0])
        raise SnapshotError(
            f"mesh '{mesh.name}': vertex {bad} has coordinates that are not finite;"
            " remove the vertex or the modifier that made it"
        )
    corner_vertices = np.empty(len(mesh.loops), np.int32)
    if len(corner_vertices):
        mesh.attributes[".corner_vert"].data.foreach_get("value", corner_vertices)
    corners = _triangle_corners(mesh)
    slots, corners = _sorted_by_slot(mesh, corners)
    vertex_values, corner_values = {}, {}
    for attribute in mesh.color_attributes:
        target = vertex_values if attribute.domain == "POINT" else corner_values
        values = np.empty((len(attribute.data), 4), np.float32)
        attribute.data.foreach_get("color", values.reshape(-1))
        target[f"color:{attribute.name}"] = values
    for layer in mesh.uv_layers:
        values = np.empty((len(mesh.loops), 2), np.float32)
        layer.uv.foreach_get("vector", values.reshape(-1))
        corner_values[f"uv:{layer.name}"] = values
    source, index = split_vertices(corner_vertices, len(positions), corner_values)
    attributes = {}
    for key, values in vertex_values.items():
        attributes[key] = np.take(values, source.vertices, axis=0)
    for key, values in corner_values.items():
        attributes[key] = np.take(values, source.corners, axis=0)
    active = next((layer.name for layer in mesh.uv_layers if layer.active_render), None)
    if active is not None:
        attributes["uv:"] = attributes[f"uv:{active}"]
    return MeshSnapshot(
        uid=next_uid(),
        name=mesh.name,
        positions=np.take(positions, source.vertices, axis=0),
        triangles=np.take(index, corners),
        slots=slots,
        attributes=attributes,
    )


class _Source:
    def __init__(self, vertices, corners):
        self.vertices = vertices
        self.corners = corners


def split_vertices(corner_vertices, vertex_count, corner_values):
    """Find the fewest vertices that carry every corner's values.

    Parameters
    ----------
    corner_vertices : ndarray of shape (C,)
    vertex_count : int
    corner_values : dict of str to ndarray of shape (C, k)

    Returns
    -------
    source : object
        ``vertices`` and ``corners``: where each new vertex takes its vertex and corner values.
    index : ndarray of shape (C,)
        int32, each corner's new vertex.
    """
    count = len(corner_vertices)
    first = np.zeros(vertex_count, np.int32)
    first[corner_vertices] = np.arange(count, dtype=np.int32)
    differs = np.zeros(count, bool)
    for values in corner_values.values():
        differs |= (values != np.take(values, np.take(first, corner_vertices), axis=0)).any(axis=1)
    extra = np.flatnonzero(differs)
    index = corner_vertices.copy()
    corners = first
    vertices = np.arange(vertex_count, dtype=np.int32)
    if len(extra):
        keys = np.column_stack(
            [corner_vertices[extra].astype(np.int32)]
            + [v[extra].view(np.int32) for v in corner_values.values()]
        )
        _, unique, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        corners = np.concatenate([first, extra[unique].astype(np.int32)])
        vertices = np.concatenate([vertices, corner_vertices[extra[unique]]])
        index[extra] = vertex_count + inverse.reshape(-1)
    return _Source(vertices, corners), index


def _triangle_corners(mesh):
    if len(mesh.loops) == 3 * len(mesh.polygons):
        sizes = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("loop_total", sizes)
        if (sizes == 3).all():
            return np.arange(len(mesh.loops), dtype=np.int32).reshape(-1, 3)
    mesh.calc_loop_triangles()
    corners = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("loops", corners.reshape(-1))
    return corners


def _sorted_by_slot(mesh, corners):
    attribute = mesh.attributes.get("material_index")
    if attribute is None or len(corners) == 0:
        return ((0, 0, len(corners)),) if len(corners) else (), corners
    per_polygon = np.empty(len(mesh.polygons), np.int32)
    attribute.data.foreach_get("value", per_polygon)
    if len(corners) == len(per_polygon):
        material = per_polygon
    else:
        polygon = np.empty(len(corners), np.int32)
        mesh.loop_triangles.foreach_get("polygon_index", polygon)
        material = np.take(per_polygon, polygon)
    order = np.argsort(material, kind="stable")
    values, first, counts = np.unique(material[order], return_index=True, return_counts=True)
    slots = tuple(zip(values.tolist(), first.tolist(), counts.tolist(), strict=True))
    return slots, np.take(corners, order, axis=0)
