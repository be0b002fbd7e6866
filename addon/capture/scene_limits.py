"""Warnings about the parts of a scene that its layers cannot show as a lens would."""

import os

import bpy

_GLASS = {"BSDF_GLASS", "BSDF_REFRACTION"}


def limits_of(scene, layer):
    """Return warnings about the parts of a scene that its layers cannot show as a lens would.

    Parameters
    ----------
    scene : bpy.types.Scene
    layer : str
        Of its view layers.

    Returns
    -------
    list of str
    """
    depsgraph = scene.view_layers[layer].depsgraph
    glass, smoke, hair = {}, {}, {}
    for instance in depsgraph.object_instances:
        shown = instance.object
        if shown.type == "VOLUME":
            smoke[shown.original.name] = None
        elif shown.type == "CURVES" or any(
            system.settings.type == "HAIR" for system in shown.particle_systems
        ):
            hair[shown.original.name] = None
        for slot in shown.material_slots:
            kinds = _kinds(slot.material)
            if kinds & _GLASS:
                glass[slot.material.original.name] = None
            if "VOLUME" in kinds:
                smoke[shown.original.name] = None
    lines = []
    if glass:
        lines.append(
            f"what is seen through glass or in mirrors is as sharp or blurred as the glass itself"
            f" (materials {_listed(glass)})"
        )
    if smoke:
        lines.append(
            f"smoke and fog are cut at the layers' bounds and have no depth of their own"
            f" ({_listed(smoke)})"
        )
    if hair:
        lines.append(
            f"hair has one depth a pixel in each layer, and edges that are softer than in the"
            f" picture ({_listed(hair)})"
        )
    return lines


def _kinds(block):
    tree = getattr(block, "node_tree", None)
    if tree is None:
        return set()
    found, waiting = set(), [tree]
    seen = set()
    while waiting:
        tree = waiting.pop()
        if tree in seen:
            continue
        seen.add(tree)
        for node in tree.nodes:
            found.add(node.type)
            if node.type == "GROUP" and node.node_tree is not None:
                waiting.append(node.node_tree)
            elif node.type == "BSDF_PRINCIPLED" and _transmits(node):
                found.add("BSDF_GLASS")
            elif node.type == "OUTPUT_MATERIAL" and node.inputs["Volume"].is_linked:
                found.add("VOLUME")
    return found


def _transmits(node):
    weight = node.inputs["Transmission Weight"]
    return weight.is_linked or weight.default_value > 0.0


def _listed(names, most=3):
    shown = [f"'{name}'" for name in list(names)[:most]]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


def missing_images():
    """Return a warning for each image whose file is missing.

    Returns
    -------
    list of str
    """
    lines = []
    for image in bpy.data.images:
        if image.source != "FILE" or not image.users or image.packed_file or not image.filepath:
            continue
        if not os.path.isfile(bpy.path.abspath(image.filepath, library=image.library)):
            lines.append(
                f"image '{image.name}': its file '{image.filepath}' is missing; renderers show it"
                " in pink"
            )
    return lines
