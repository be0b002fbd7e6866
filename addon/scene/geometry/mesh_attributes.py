"""Reads attributes of evaluated Blender meshes: normals, tangents, UV maps, colours."""

import numpy as np

# By the attribute's type: member of its elements that holds the value, and number of components.
_VALUE_MEMBERS = {
    "FLOAT": ("value", 1),
    "INT": ("value", 1),
    "INT8": ("value", 1),
    "BOOLEAN": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    # "color" is scene linear; "color_srgb" would be as stored.
    "BYTE_COLOR": ("color", 4),
}
_UV_TYPES = {"FLOAT2"}
_COLOR_TYPES = set(_VALUE_MEMBERS) - _UV_TYPES


def read_normals(mesh):
    """Return normals, and the domain that they are of: points or corners."""
    if mesh.normals_domain == "POINT":
        source, domain = mesh.vertex_normals, "POINT"
    else:
        source, domain = mesh.corner_normals, "CORNER"
    normals = np.empty((len(source), 3), np.float32)
    if len(normals):
        source.foreach_get("vector", normals.reshape(-1))
    return normals, domain


def read_tangents(mesh, name):
    """Return tangents and signs, shape (L, 4), or None where Blender makes none.

    It makes none without a UV map, and of meshes with faces of more than 4 corners.
    """
    layer = find_attribute(mesh, "uv", name)
    if layer is None:
        return None
    try:
        mesh.calc_tangents(uvmap=layer.name)
    except RuntimeError:
        return None
    tangents = np.empty((len(mesh.loops), 4), np.float32)
    part = np.empty(3 * len(tangents), np.float32)
    mesh.loops.foreach_get("tangent", part)
    tangents[:, :3] = part.reshape(-1, 3)
    part = part[: len(tangents)].copy()
    mesh.loops.foreach_get("bitangent_sign", part)
    tangents[:, 3] = part
    mesh.free_tangents()
    return tangents


def find_attribute(mesh, kind, name):
    """Return an attribute of a mesh that a key of `MeshSnapshot.attributes` means, or None."""
    if kind == "uv":
        if not name:
            layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
            name = layer.name if layer else ""
        types = _UV_TYPES
    else:
        if not name:
            index = mesh.color_attributes.render_color_index
            inside = 0 <= index < len(mesh.color_attributes)
            name = mesh.color_attributes[index].name if inside else ""
        types = _COLOR_TYPES
    attribute = mesh.attributes.get(name) if name else None
    if attribute is None or attribute.data_type not in types or attribute.domain == "EDGE":
        return None
    return attribute


def read_attribute(mesh, attribute, kind):
    """Return values of shape (N, components), and the domain that they are of."""
    member, components = _VALUE_MEMBERS[attribute.data_type]
    count = len(attribute.data)
    # Only float32 and the stored type are copied in one piece; numpy converts the others.
    stored = {"INT": np.int32, "INT8": np.int8, "BOOLEAN": bool}.get(attribute.data_type)
    values = np.empty((count, components), stored or np.float32)
    if count:
        attribute.data.foreach_get(member, values.reshape(-1))
    values = values.astype(np.float32, copy=False)
    if kind == "color" and components != 4:
        # As shader nodes see it: a number is grey, a vector is a colour.
        opaque = np.ones((count, 4), np.float32)
        opaque[:, :3] = values
        values = opaque
    domain = attribute.domain
    if domain == "FACE":
        values = np.repeat(values, polygon_sizes(mesh), axis=0)
        domain = "CORNER"
    return values, domain


def without_infinite(mesh, values, domain, corner_vertices):
    """Return corner values with 0 all over a face where a corner's value is not finite.

    Each component by itself: interpolation from such a corner is not finite anywhere in the face,
    and Cycles draws it as 0.
    """
    if domain == "POINT":
        values = np.take(values, corner_vertices, axis=0)
    sizes = polygon_sizes(mesh)
    polygon = np.repeat(np.arange(len(sizes)), sizes)
    corner, component = np.nonzero(~np.isfinite(values))
    lost = np.zeros((len(sizes), values.shape[1]), bool)
    lost[polygon[corner], component] = True
    values[lost[polygon]] = 0.0
    return values


def polygon_sizes(mesh):
    """Return the number of corners of each polygon."""
    sizes = np.empty(len(mesh.polygons), np.int32)
    if len(sizes):
        mesh.polygons.foreach_get("loop_total", sizes)
    return sizes
