"""Readers of Blender's nodes that tell of the mesh, the object, the camera and the ray."""

import numpy as np

from ...snapshot.surface_graph import Constant, Link
from .tree_reader import reader_registry

READERS, reads = reader_registry()


@reads("RGB", "VALUE")
def _stated(reader, node, groups):
    return {node.outputs[0].identifier: reader.constant(node.outputs[0])}


# Nodes that Blender puts where it has computed a constant, and the property that holds it.
_FOLDED = {"INPUT_VECTOR": "vector", "INPUT_INT": "integer", "INPUT_BOOL": "boolean"}
_FOLDED |= {"INPUT_ROTATION": "rotation_euler"}


@reads(*_FOLDED)
def _folded(reader, node, groups):
    value = getattr(node, _FOLDED[node.type])
    numbers = tuple(map(float, value)) if hasattr(value, "__len__") else (float(value),)
    return {node.outputs[0].identifier: Constant(numbers)}


@reads("UVMAP")
def _uv_map(reader, node, groups):
    return reader.add("uv", settings=(("name", node.uv_map),))


@reads("TEX_COORD")
def _texture_coordinate(reader, node, groups):
    if node.from_instancer:
        reader.note("coordinates from the instancer are not read; those of the object are used")
    other = reader.add("texture_coordinate")
    outputs = {name: Link(other, name) for name in ("Normal", "Camera", "Window", "Reflection")}
    outputs["UV"] = Link(reader.add("uv"), "UV")
    outputs["Generated"] = Link(reader.add("generated"), "Generated")
    outputs["Object"] = Link(other, "Object")
    if node.object is not None:
        # The object's own space, as numbers that may change without another shader.
        inverse = np.array(node.object.matrix_world.inverted_safe(), np.float64)
        place = ("Vector", Link(reader.add("geometry"), "Position"))
        rows = [(axis, Constant(tuple(row[:3]))) for axis, row in zip("XYZ", inverse, strict=False)]
        offset = ("Offset", Constant(tuple(inverse[:3, 3])))
        outputs["Object"] = Link(reader.add("affine", [place, *rows, offset]), "Vector")
    return outputs


@reads("VERTEX_COLOR")
def _color_attribute(reader, node, groups):
    return reader.add("color_attribute", settings=(("name", node.layer_name),))


@reads("ATTRIBUTE")
def _attribute(reader, node, groups):
    if node.attribute_type != "GEOMETRY":
        return None
    return reader.add("attribute", settings=(("name", node.attribute_name),))


_OF_VERTICES = {"Pointiness": "pointiness", "Random Per Island": "island"}
_OF_VERTICES |= {"Parametric": "parametric"}


@reads("NEW_GEOMETRY")
def _geometry(reader, node, groups):
    index = reader.add("geometry")
    outputs = {}
    for socket in node.outputs:
        outputs[socket.identifier] = Link(index, socket.identifier)
        if socket.identifier in _OF_VERTICES:
            kind = _OF_VERTICES[socket.identifier]
            # Computed only where something reads it.
            known = Link(reader.add(kind), "Value") if socket.is_linked else Constant((0.0,))
            outputs[socket.identifier] = known
    return outputs


@reads("OBJECT_INFO")
def _object_info(reader, node, groups):
    index = reader.add("object_info")
    names = ("Location", "Color", "Alpha", "Object Index", "Random")
    outputs = {name: Link(index, name) for name in names}
    outputs["Material Index"] = Constant((float(reader.pass_index),))
    return outputs


@reads("CAMERA")
def _camera_data(reader, node, groups):
    return reader.add("camera_data")


@reads("FRESNEL")
def _fresnel(reader, node, groups):
    return reader.add(
        "fresnel", reader.values(node, ("IOR",), groups) + reader.normal(node, groups)
    )


@reads("LAYER_WEIGHT")
def _layer_weight(reader, node, groups):
    inputs = reader.values(node, ("Blend",), groups) + reader.normal(node, groups)
    return reader.add("layer_weight", inputs)


@reads("LIGHT_PATH")
def _light_path(reader, node, groups):
    # As a ray from the camera sees it.
    outputs = {socket.identifier: Constant((0.0,)) for socket in node.outputs}
    outputs["Is Camera Ray"] = Constant((1.0,))
    outputs["Ray Length"] = Link(reader.add("camera_data"), "View Distance")
    return outputs


@reads("TANGENT")
def _tangent(reader, node, groups):
    radial = node.direction_type == "RADIAL"
    settings = (("axis", node.axis),) if radial else (("name", node.uv_map),)
    return reader.add("tangent", settings=settings)


# Jenkins' hash of twice 0, as a share.
_RANDOM_OF_NO_PARTICLE = 0.8603128


@reads("HAIR_INFO", "PARTICLE_INFO", "POINT_INFO")
def _of_other_geometry(reader, node, groups):
    # What Cycles gives on a mesh that is none of these.
    outputs = {
        socket.identifier: Constant((0.0,) * (3 if socket.type == "VECTOR" else 1))
        for socket in node.outputs
    }
    if node.type == "PARTICLE_INFO":
        outputs["Random"] = Constant((_RANDOM_OF_NO_PARTICLE,))
    return outputs


@reads("AMBIENT_OCCLUSION")
def _ambient_occlusion(reader, node, groups):
    reader.note(f"node '{node.bl_label}' sees nothing near; its colour is used, and 1")
    return {"Color": reader.value(node, "Color", groups), "AO": Constant((1.0,))}


@reads("BEVEL")
def _bevel(reader, node, groups):
    reader.note(f"node '{node.bl_label}' rounds nothing; the normal is used as it is")
    normal = reader.normal(node, groups)
    return {"Normal": normal[0][1] if normal else Link(reader.add("geometry"), "Normal")}


@reads("WIREFRAME")
def _wireframe(reader, node, groups):
    inputs = reader.values(node, ("Size",), groups)
    settings = (("pixels", "1" if node.use_pixel_size else ""),)
    return reader.add("wireframe", inputs, settings)


@reads("VOLUME_INFO")
def _volume_info(reader, node, groups):
    # What Cycles gives on a surface.
    return {
        socket.identifier: Constant((0.0,) * (3 if socket.type == "RGBA" else 1))
        for socket in node.outputs
    }
