"""The data-blocks that warnings name: who shows them, and whether final renders do."""

# Of node groups within one another.
_DEEPEST = 16


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
        False only for objects that are switched off for renders, by themselves or by all their
        collections.
    """
    obj = scene.objects.get(name) if kind == "object" else None
    if obj is None:
        return True
    return not obj.hide_render and _is_in_rendered(scene.collection, obj)


def _is_in_rendered(collection, obj):
    if collection.hide_render:
        return False
    if collection.objects.get(obj.name) is obj:
        return True
    return any(_is_in_rendered(child, obj) for child in collection.children)


def objects_of(view_layer, kind, name):
    """Return the objects of a view layer that show a data-block.

    Parameters
    ----------
    view_layer : bpy.types.ViewLayer
    kind, name : str
        As `engine.report.subject_of` returns them. Of an image and a material, those whose
        material slots lead to it.

    Returns
    -------
    list of (bpy.types.Object, int)
        Each with the number of the first slot that leads there, or 0.
    """
    if kind in {"object", "camera"}:
        obj = view_layer.objects.get(name)
        return [(obj, 0)] if obj is not None else []
    if kind == "material":
        return list(_with_material(view_layer, lambda material: material.name == name))
    if kind == "image":
        known = {}

        def shows(material):
            if material not in known:
                known[material] = _has_image(material.node_tree, name, _DEEPEST)
            return known[material]

        return list(_with_material(view_layer, shows))
    return []


def _with_material(view_layer, fits):
    for obj in view_layer.objects:
        for slot in obj.material_slots:
            if slot.material is not None and fits(slot.material):
                yield obj, slot.slot_index
                break


def _has_image(tree, name, depth):
    if tree is None or depth == 0:
        return False
    for node in tree.nodes:
        image = getattr(node, "image", None)
        if image is not None and image.name == name:
            return True
        if node.type == "GROUP" and _has_image(node.node_tree, name, depth - 1):
            return True
    return False
