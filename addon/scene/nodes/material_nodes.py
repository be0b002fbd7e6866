"""From Blender's shader nodes, textures and coordinates to the nodes of a `SurfaceGraph`."""

import numpy as np

from ...snapshot.surface_graph import MISSING_IMAGE_COLOR, Constant, Link
from .node_tree import source_of
from .tree_reader import constant, input_socket, is_constant, reader_registry

READERS, reads = reader_registry()


# -- closures ------------------------------------------------------------------------------------


@reads("EMISSION")
def _emission(reader, node, groups):
    return reader.add("emission", reader.values(node, ("Color", "Strength"), groups))


def _note_normal(reader, node, groups, *identifiers):
    for identifier in identifiers:
        if reader.linked(node, identifier, groups):
            reader.note(f"'{identifier}' of node '{node.bl_label}' is not read")


# Inputs of the Principled BSDF that are not drawn, and the value at which they have no effect.
_PRINCIPLED_LEFT_OUT = {
    "Transmission Weight": 0.0,
    "Subsurface Weight": 0.0,
    "Coat Weight": 0.0,
    "Sheen Weight": 0.0,
    "Anisotropic": 0.0,
    "Diffuse Roughness": 0.0,
    "Thin Film Thickness": 0.0,
}


@reads("BSDF_PRINCIPLED")
def _principled(reader, node, groups):
    for identifier, default in _PRINCIPLED_LEFT_OUT.items():
        socket = input_socket(node, identifier)
        if socket is None:
            continue
        source, _ = source_of(socket, groups)
        if source.is_output or not is_constant(constant(source), default):
            name = identifier.removesuffix(" Weight").lower()
            reader.note(f"{name} is not drawn")
    _note_normal(reader, node, groups, "Normal", "Coat Normal", "Tangent")
    inputs = reader.values(
        node,
        (
            "Base Color",
            "Metallic",
            "Roughness",
            "IOR",
            "Specular IOR Level",
            "Specular Tint",
            "Emission Color",
            "Emission Strength",
        ),
        groups,
    )
    alpha = reader.value(node, "Alpha", groups)
    if not (isinstance(alpha, Constant) and alpha.value[0] >= 1.0):
        inputs.append(("Alpha", alpha))
    return reader.add("principled", inputs)


# Shader nodes that are drawn as a diffuse surface, with a warning.
_AS_DIFFUSE = {
    "BSDF_TRANSLUCENT": "Color",
    "SUBSURFACE_SCATTERING": "Color",
    "BSDF_SHEEN": "Color",
    "BSDF_TOON": "Color",
    "BSDF_HAIR": "Color",
}
_AS_GLOSSY = {"BSDF_GLASS": "Color", "BSDF_REFRACTION": "Color", "BSDF_METALLIC": "Base Color"}


@reads("BSDF_DIFFUSE", *_AS_DIFFUSE)
def _diffuse(reader, node, groups):
    if node.type in _AS_DIFFUSE:
        reader.note(f"node '{node.bl_label}' is drawn as a diffuse surface")
    elif not is_constant(reader.value(node, "Roughness", groups), 0.0):
        reader.note("roughness of a diffuse surface is not drawn")
    _note_normal(reader, node, groups, "Normal")
    color = reader.value(node, _AS_DIFFUSE.get(node.type, "Color"), groups)
    return Link(reader.add("diffuse", [("Color", color)]), "BSDF")


@reads("BSDF_GLOSSY", *_AS_GLOSSY)
def _glossy(reader, node, groups):
    if node.type in _AS_GLOSSY:
        reader.note(f"node '{node.bl_label}' is drawn as a glossy surface")
    _note_normal(reader, node, groups, "Normal", "Tangent")
    if input_socket(node, "Anisotropy") and not is_constant(
        reader.value(node, "Anisotropy", groups), 0.0
    ):
        reader.note("anisotropy is not drawn")
    color = reader.value(node, _AS_GLOSSY.get(node.type, "Color"), groups)
    roughness = reader.value(node, "Roughness", groups)
    # Scattering more than once brightens rough surfaces; other distributions leave it out.
    multiple = getattr(node, "distribution", "MULTI_GGX") == "MULTI_GGX"
    settings = (("multiple_scattering", "1" if multiple else ""),)
    inputs = [("Color", color), ("Roughness", roughness)]
    return Link(reader.add("glossy", inputs, settings), "BSDF")


@reads("BSDF_TRANSPARENT")
def _transparent(reader, node, groups):
    color = reader.value(node, "Color", groups)
    if not (isinstance(color, Constant) and len(set(color.value)) == 1):
        reader.note("light that passes a transparent surface keeps its colour, dimmed by the mean")
    if isinstance(color, Constant) and not 0.0 <= np.mean(color.value) <= 1.0:
        reader.note(
            "a transparent surface whose colour is not between 0 and 1 is drawn as if it were"
        )
    return reader.add("transparent", [("Color", color)])


@reads("HOLDOUT")
def _holdout(reader, node, groups):
    return reader.add("holdout")


@reads("MIX_SHADER")
def _mix_shader(reader, node, groups):
    factor = reader.value(node, "Fac", groups)
    if isinstance(factor, Constant) and (factor.value[0] <= 0.0 or factor.value[0] >= 1.0):
        chosen = "Shader" if factor.value[0] <= 0.0 else "Shader_001"
        return reader.closure(node, chosen, groups) or Link(reader.add("none"), "BSDF")
    inputs = [("Fac", factor), *_two_closures(reader, node, groups)]
    return reader.add("mix_shader", inputs)


@reads("ADD_SHADER")
def _add_shader(reader, node, groups):
    return reader.add("add_shader", _two_closures(reader, node, groups))


def _two_closures(reader, node, groups):
    pairs = []
    for identifier in ("Shader", "Shader_001"):
        link = reader.closure(node, identifier, groups)
        pairs.append((identifier, link or Link(reader.add("none"), "BSDF")))
    return pairs


# -- values --------------------------------------------------------------------------------------


@reads("RGB", "VALUE")
def _stated(reader, node, groups):
    return {node.outputs[0].identifier: reader.constant(node.outputs[0])}


@reads("TEX_IMAGE")
def _image_texture(reader, node, groups):
    if node.image is None:
        # As Cycles draws a node without image; EEVEE draws it in black.
        return {"Color": Constant(MISSING_IMAGE_COLOR), "Alpha": Constant((1.0,))}
    use = reader.use_image(node)
    if use is None:
        return {"Color": Constant(MISSING_IMAGE_COLOR), "Alpha": Constant((1.0,))}
    if node.projection != "FLAT":
        reader.note(f"{node.projection.lower()} projection of an image is drawn flat")
    interpolation = node.interpolation
    if interpolation in {"Cubic", "Smart"}:
        reader.note("cubic interpolation of an image is drawn as linear")
        interpolation = "Linear"
    if reader.linked(node, "Vector", groups):
        vector = reader.value(node, "Vector", groups)
    else:
        vector = Link(reader.add("uv"), "UV")
    settings = (
        ("interpolation", interpolation),
        ("extension", node.extension),
        ("encoding", "srgb" if use.srgb else ""),
        ("associated", "1" if use.associated else ""),
    )
    return reader.add("image_texture", [("Vector", vector)], settings, use.uid)


@reads("UVMAP")
def _uv_map(reader, node, groups):
    return reader.add("uv", settings=(("name", node.uv_map),))


@reads("TEX_COORD")
def _texture_coordinate(reader, node, groups):
    if node.from_instancer:
        reader.note("coordinates from the instancer are not read; those of the object are used")
    # The other outputs are absent, which makes the reader report them.
    return {
        "UV": Link(reader.add("uv"), "UV"),
        "Generated": Link(reader.add("generated"), "Generated"),
    }


@reads("VERTEX_COLOR")
def _color_attribute(reader, node, groups):
    return reader.add("color_attribute", settings=(("name", node.layer_name),))


@reads("ATTRIBUTE")
def _attribute(reader, node, groups):
    if node.attribute_type != "GEOMETRY":
        return None
    return reader.add("attribute", settings=(("name", node.attribute_name),))


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
