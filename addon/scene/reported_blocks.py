"""The data-blocks that warnings name: who shows them, and whether final renders do.

Warnings name data-blocks in full, as Blender does: of a linked one with its library.
"""

import re

import bpy

# Of node groups within one another.
_DEEPEST = 16
_LINKED = re.compile(r"(.*) \[(.*)\]", re.DOTALL)
_LISTS = {
    "object": "objects",
    "camera": "objects",
    "material": "materials",
    "image": "images",
    "world": "worlds",
    "scene": "scenes",
}


def block_named(kind, name):
    """Return the data-block of a kind and full name, or None.

    Parameters
    ----------
    kind, name : str
        As `engine.report.subject_of` returns them; a camera is an object.
    """
    if kind not in _LISTS:
        return None
    blocks = getattr(bpy.data, _LISTS[kind])
    found = blocks.get((name, None))
    linked = _LINKED.fullmatch(name)
    if found is None and linked:
        for library in bpy.data.libraries:
            if library.name == linked[2]:
                found = found or blocks.get((linked[1], library.filepath))
    return found


def is_there(kind, name):
    """Whether there is a data-block of a kind and full name."""
    return block_named(kind, name) is not None


def is_rendered(scene, kind, name):
    """Whether final renders have a data-block, too.

    Parameters
    ----------
    scene : bpy.types.Scene
    kind, name : str
        As `engine.report.subject_of` returns them.

    Returns
    -------
    bool
        False only for objects of the scene that are switched off for renders, by themselves or by
        all their collections.
    """
    obj = block_named(kind, name) if kind == "object" else None
    if obj is None or not _has(scene, obj):
        return True
    return not obj.hide_render and _is_in_rendered(scene.collection, obj)


def _has(owner, obj):
    """Whether a scene, collection or view layer has an object, and not only its name."""
    first = owner.objects.get(obj.name)
    return first is not None and (first == obj or any(other == obj for other in owner.objects))


def _is_in_rendered(collection, obj):
    if collection.hide_render:
        return False
    if _has(collection, obj):
        return True
    return any(_is_in_rendered(child, obj) for child in collection.children)


def objects_of(depsgraph, kind, name):
    """Return the objects of a view layer that show a data-block.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
        Of the view layer.
    kind, name : str
        As `engine.report.subject_of` returns them. Of an image and a material, those whose
        material slots lead to it, and those whose modifiers or instances do.

    Returns
    -------
    list of (bpy.types.Object, int or None)
        Each with the number of the first slot that leads there, if there is one.
    """
    block, layer = block_named(kind, name), depsgraph.view_layer
    if block is None:
        return []
    if kind in {"object", "camera"}:
        return [(block, None)] if _has(layer, block) else []
    if kind not in {"material", "image"}:
        return []
    known = {}

    def shows(material):
        number = material.session_uid
        if number not in known:
            known[number] = (
                material == block
                if kind == "material"
                else _has_image(material.node_tree, block, _DEEPEST)
            )
        return known[number]

    found = dict(_with_slot(layer, shows))
    for obj in _with_geometry(depsgraph, shows, set(found)):
        found[obj] = None
    return list(found.items())


def _with_slot(view_layer, shows):
    for obj in view_layer.objects:
        for slot in obj.material_slots:
            if slot.material is not None and shows(slot.material):
                yield obj, slot.slot_index
                break


def _with_geometry(depsgraph, shows, known):
    """Return the objects whose modifiers or instances show a material, but for known ones."""
    found = {}
    for instance in depsgraph.object_instances:
        obj = instance.object
        owner = (instance.parent if instance.is_instance else obj).original
        if owner in found or owner in known or obj.original in known:
            continue
        slots = (slot.material for slot in obj.material_slots)
        materials = (*getattr(obj.data, "materials", ()), *slots)
        if any(filled is not None and shows(filled.original) for filled in materials):
            found[owner] = _has(depsgraph.view_layer, owner)
    return [owner for owner, is_here in found.items() if is_here]


def _has_image(tree, image, depth):
    if tree is None or depth == 0:
        return False
    for node in tree.nodes:
        if getattr(node, "image", None) == image:
            return True
        if node.type == "GROUP" and _has_image(node.node_tree, image, depth - 1):
            return True
    return False
