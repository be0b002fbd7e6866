"""Readers of Blender's nodes that map, turn and bend vectors."""

import numpy as np

from ...snapshot.surface_graph import Constant, Link
from .node_tree import source_of
from .tree_reader import input_socket, reader_registry

READERS, reads = reader_registry()


@reads("MAPPING")
def _mapping(reader, node, groups):
    kind = node.vector_type
    vector = reader.value(node, "Vector", groups)
    names = (
        ("Rotation", "Scale")
        if kind in {"VECTOR", "NORMAL"}
        else (
            "Location",
            "Rotation",
            "Scale",
        )
    )
    inputs = reader.values(node, names, groups)
    if kind != "NORMAL" and all(isinstance(value, Constant) for _, value in inputs):
        # Sines and cosines once here instead of once a pixel.
        matrix, offset = mapping_matrix(kind, {name: value.value for name, value in inputs})
        rows = [(axis, Constant(tuple(row))) for axis, row in zip("XYZ", matrix, strict=True)]
        inputs = [("Vector", vector), *rows, ("Offset", Constant(tuple(offset)))]
        return Link(reader.add("affine", inputs), "Vector")
    return reader.add("mapping", [("Vector", vector), *inputs], (("type", kind),))


def euler_matrix(angles):
    """Return the rotation by XYZ Euler angles, in radians, as a (3, 3) array."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(angles), np.cos(angles)
    x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return z @ y @ x


def mapping_matrix(kind, values):
    """Return the Mapping node as an affine map.

    Parameters
    ----------
    kind : {'POINT', 'TEXTURE', 'VECTOR'}
    values : dict of str to sequence of 3 float
        ``"Location"`` (in m), ``"Rotation"`` (in radians) and ``"Scale"``.

    Returns
    -------
    matrix : ndarray of shape (3, 3)
    offset : ndarray of shape (3,)
    """
    rotation = euler_matrix(values["Rotation"])
    scale = np.asarray(values["Scale"], np.float64)
    location = np.asarray(values.get("Location", (0.0, 0.0, 0.0)), np.float64)
    if kind == "TEXTURE":
        # Blender divides by zero to zero.
        inverse = np.divide(1.0, scale, out=np.zeros(3), where=scale != 0.0)
        matrix = inverse[:, None] * rotation.T
        return matrix, -matrix @ location
    return rotation * scale, location


@reads("NORMAL")
def _normal(reader, node, groups):
    direction = ("Direction", reader.constant(node.outputs["Normal"]))
    return reader.add("normal", [direction, *reader.values(node, ("Normal",), groups)])


@reads("NORMAL_MAP")
def _normal_map(reader, node, groups):
    inputs = reader.values(node, ("Color", "Strength"), groups)
    settings = [("space", node.space), ("directx", "1" if node.convention == "DIRECTX" else "")]
    if node.space == "TANGENT":
        settings.append(("name", node.uv_map))
    return reader.add("normal_map", inputs, settings)


@reads("BUMP")
def _bump(reader, node, groups):
    inputs = reader.values(node, ("Strength", "Distance", "Height"), groups)
    inputs += reader.normal(node, groups)
    return reader.add("bump", inputs, (("invert", "1" if node.invert else ""),))


@reads("VECTOR_ROTATE")
def _vector_rotate(reader, node, groups):
    kind = node.rotation_type
    names = {"EULER_XYZ": ("Rotation",), "AXIS_ANGLE": ("Axis", "Angle")}.get(kind, ("Angle",))
    inputs = reader.values(node, ("Vector", "Center", *names), groups)
    settings = (("type", kind), ("invert", "1" if node.invert else ""))
    return reader.add("vector_rotate", inputs, settings)


@reads("VECT_TRANSFORM")
def _vector_transform(reader, node, groups):
    settings = (
        ("type", node.vector_type),
        ("from", node.convert_from),
        ("to", node.convert_to),
    )
    return reader.add("vector_transform", reader.values(node, ("Vector",), groups), settings)


def read_displacement(reader, output):
    """Add a node that bends the surface's normal as its displacement does; none without one.

    Parameters
    ----------
    reader : TreeReader
    output : bpy.types.Node
        Of the material.
    """
    source, groups = source_of(input_socket(output, "Displacement"), ())
    if not source.is_output:
        return
    node = source.node
    kind, space = "VECTOR", "WORLD"
    if node.type == "DISPLACEMENT":
        kind, space = "HEIGHT", node.space
        inputs = reader.values(node, ("Height", "Midlevel", "Scale"), groups)
    elif node.type == "VECTOR_DISPLACEMENT":
        space = node.space
        inputs = reader.values(node, ("Vector", "Midlevel", "Scale"), groups)
    else:
        inputs = [("Vector", reader.value(output, "Displacement", ()))]
        inputs += [("Midlevel", Constant((0.0,))), ("Scale", Constant((1.0,)))]
    reader.add("displacement", inputs, (("kind", kind), ("space", space)))
