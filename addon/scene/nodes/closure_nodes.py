"""Readers of Blender's closures."""

import numpy as np

from ...snapshot.surface_graph import Constant, Link
from .node_tree import source_of
from .tree_reader import constant, input_socket, is_constant, reader_registry

READERS, reads = reader_registry()


@reads("EMISSION")
def _emission(reader, node, groups):
    return reader.add("emission", reader.values(node, ("Color", "Strength"), groups))


def _note_linked(reader, node, groups, *identifiers):
    for identifier in identifiers:
        if reader.linked(node, identifier, groups):
            reader.note(f"'{identifier}' of node '{node.bl_label}' is not read")


# Inputs of the Principled BSDF that are not drawn, and the value at which they have no effect.
_PRINCIPLED_LEFT_OUT = {
    "Anisotropic": 0.0,
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
    _note_linked(reader, node, groups, "Tangent")
    if not is_constant(reader.value(node, "Subsurface Weight", groups), 0.0):
        reader.note(_AS_ENTERED)
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
        reader.note(_THROUGH_GLASS)
    alpha = reader.value(node, "Alpha", groups)
    if not (isinstance(alpha, Constant) and alpha.value[0] >= 1.0):
        inputs.append(("Alpha", alpha))
    return reader.add("principled", inputs)


_THROUGH_GLASS = "glass does not bend what is seen through it, nor blur it"

_AS_ENTERED = "light below a surface leaves it where it enters: it is drawn as diffuse"


@reads("BSDF_DIFFUSE", "SUBSURFACE_SCATTERING")
def _diffuse(reader, node, groups):
    inputs = [*reader.values(node, ("Color",), groups), *reader.normal(node, groups)]
    if node.type == "SUBSURFACE_SCATTERING":
        reader.note(_AS_ENTERED)
    else:
        rough = reader.value(node, "Roughness", groups)
        if not is_constant(rough, 0.0):
            inputs.append(("Roughness", rough))
    return {node.outputs[0].identifier: Link(reader.add("diffuse", inputs), "BSDF")}


def _multiple(node):
    # Scattering more than once brightens rough surfaces; other distributions leave it out.
    multiple = getattr(node, "distribution", "MULTI_GGX") == "MULTI_GGX"
    return ("multiple_scattering", "1" if multiple else "")


def _note_anisotropy(reader, node, groups):
    if not is_constant(reader.value(node, "Anisotropy", groups), 0.0):
        reader.note("anisotropy is not drawn")
    _note_linked(reader, node, groups, "Tangent")


@reads("BSDF_GLOSSY")
def _glossy(reader, node, groups):
    _note_anisotropy(reader, node, groups)
    inputs = reader.values(node, ("Color", "Roughness"), groups) + reader.normal(node, groups)
    return Link(reader.add("glossy", inputs, (_multiple(node),)), "BSDF")


@reads("BSDF_METALLIC")
def _metallic(reader, node, groups):
    _note_anisotropy(reader, node, groups)
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
    reader.note(_THROUGH_GLASS)
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
