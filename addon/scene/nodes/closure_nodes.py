"""Readers of Blender's closures."""

from ...snapshot.surface_graph import Constant, Link
from .tree_reader import is_constant, reader_registry

READERS, reads = reader_registry()


@reads("EMISSION")
def _emission(reader, node, groups):
    return reader.add("emission", reader.values(node, ("Color", "Strength"), groups))


def _note_linked(reader, node, groups, *identifiers):
    for identifier in identifiers:
        if reader.linked(node, identifier, groups):
            reader.note(f"'{identifier}' of node '{node.bl_label}' is not read")


# Inputs of closures that are not drawn, and the value at which they have no effect.
_LEFT_OUT = {"Anisotropic": 0.0, "Anisotropy": 0.0, "Thin Film Thickness": 0.0, "Thin Wall": 0.0}


def _note_left_out(reader, node, groups):
    """Tell, with the node's name, which inputs that have an effect are not drawn."""
    for socket in node.inputs:
        if socket.identifier in _LEFT_OUT and socket.enabled:
            value = reader.value(node, socket.identifier, groups)
            if not is_constant(value, _LEFT_OUT[socket.identifier]):
                reader.note(f"{socket.name.lower()} of node '{node.bl_label}' is not drawn")
    _note_linked(reader, node, groups, "Tangent")


@reads("BSDF_PRINCIPLED")
def _principled(reader, node, groups):
    _note_left_out(reader, node, groups)
    if not is_constant(reader.value(node, "Subsurface Weight", groups), 0.0):
        reader.note(_AS_ENTERED.format(node.bl_label))
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
    inputs += reader.normal(node, groups)
    coat = reader.value(node, "Coat Weight", groups)
    if not is_constant(coat, 0.0):
        names = ("Coat Roughness", "Coat IOR", "Coat Tint")
        inputs += [("Coat Weight", coat), *reader.values(node, names, groups)]
        if reader.linked(node, "Coat Normal", groups):
            inputs += reader.values(node, ("Coat Normal",), groups)
    sheen = reader.value(node, "Sheen Weight", groups)
    if not is_constant(sheen, 0.0):
        names = ("Sheen Roughness", "Sheen Tint")
        inputs += [("Sheen Weight", sheen), *reader.values(node, names, groups)]
    rough = reader.value(node, "Diffuse Roughness", groups)
    if not is_constant(rough, 0.0):
        inputs.append(("Diffuse Roughness", rough))
    transmission = reader.value(node, "Transmission Weight", groups)
    if not is_constant(transmission, 0.0):
        inputs.append(("Transmission Weight", transmission))
    alpha = reader.value(node, "Alpha", groups)
    if not (isinstance(alpha, Constant) and alpha.value[0] >= 1.0):
        inputs.append(("Alpha", alpha))
    return reader.add("principled", inputs)


_AS_ENTERED = "subsurface light of node '{}' leaves where it enters: it is drawn as diffuse"


@reads("BSDF_DIFFUSE", "SUBSURFACE_SCATTERING")
def _diffuse(reader, node, groups):
    inputs = [*reader.values(node, ("Color",), groups), *reader.normal(node, groups)]
    if node.type == "SUBSURFACE_SCATTERING":
        reader.note(_AS_ENTERED.format(node.bl_label))
    else:
        rough = reader.value(node, "Roughness", groups)
        if not is_constant(rough, 0.0):
            inputs.append(("Roughness", rough))
    return {node.outputs[0].identifier: Link(reader.add("diffuse", inputs), "BSDF")}


def _multiple(node):
    # Scattering more than once brightens rough surfaces; other distributions leave it out.
    multiple = getattr(node, "distribution", "MULTI_GGX") == "MULTI_GGX"
    return ("multiple_scattering", "1" if multiple else "")


@reads("BSDF_GLOSSY")
def _glossy(reader, node, groups):
    _note_left_out(reader, node, groups)
    inputs = reader.values(node, ("Color", "Roughness"), groups) + reader.normal(node, groups)
    return Link(reader.add("glossy", inputs, (_multiple(node),)), "BSDF")


@reads("BSDF_METALLIC")
def _metallic(reader, node, groups):
    _note_left_out(reader, node, groups)
    if node.fresnel_type == "F82":
        color, edge = (reader.value(node, name, groups) for name in ("Base Color", "Edge Tint"))
    else:
        # Head on; towards the edge every metal gets white.
        optics = reader.values(node, ("IOR", "Extinction"), groups)
        color, edge = Link(reader.add("conductor", optics), "Color"), Constant((1.0,) * 3)
    inputs = [("Color", color), ("Edge Tint", edge), *reader.values(node, ("Roughness",), groups)]
    inputs += reader.normal(node, groups)
    return Link(reader.add("metallic", inputs, (_multiple(node),)), "BSDF")


@reads("BSDF_GLASS", "BSDF_REFRACTION")
def _glass(reader, node, groups):
    _note_left_out(reader, node, groups)
    inputs = reader.values(node, ("Color", "Roughness", "IOR"), groups)
    inputs += reader.normal(node, groups)
    mirrors = "1" if node.type == "BSDF_GLASS" else ""
    return Link(reader.add("glass", inputs, (_multiple(node), ("mirrors", mirrors))), "BSDF")


@reads("BSDF_TRANSLUCENT")
def _translucent(reader, node, groups):
    inputs = reader.values(node, ("Color",), groups) + reader.normal(node, groups)
    return Link(reader.add("translucent", inputs), "BSDF")


@reads("BSDF_TRANSPARENT")
def _transparent(reader, node, groups):
    return reader.add("transparent", reader.values(node, ("Color",), groups))


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
