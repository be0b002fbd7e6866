"""A scene's compositing node group with Aplanat in it; what is there already stays.

A scene's picture goes through its ``compositing_node_group``, which ends in a Group Output; the
first input of that is the picture.
"""

import bpy

from ..engine.render_engine import ENGINE_ID
from .node_groups import MIX, is_ours, node_group

_STEP = 240.0


def wire_render(scene, view_layer):
    """Send a view layer's render through `Aplanat Mix`.

    The passes Defocus and Bokeh are switched on. Whatever took the picture from the Render Layers
    node takes it from the Mix, which gives the same picture until its settings are changed. A scene
    that is wired already is left, except for links of the Mix that are missing.

    Parameters
    ----------
    scene : bpy.types.Scene
    view_layer : bpy.types.ViewLayer

    Returns
    -------
    changed : bool
    notes : list of str
        What the user has to do, one sentence each.
    """
    changed = _switch_on(scene)
    if scene.render.engine == ENGINE_ID:
        for name in ("use_pass_defocus", "use_pass_bokeh"):
            if not getattr(view_layer.aplanat, name):
                setattr(view_layer.aplanat, name, True)
                changed = True
    # Sockets of the node follow from the passes.
    view_layer.update_render_passes()
    tree = scene.compositing_node_group
    source, is_new = _render_layers(tree, scene, view_layer)
    changed |= is_new
    mix, is_new = _mix_of(tree, source)
    changed |= is_new
    picture = source.outputs["Image"]
    if is_new:
        _take_over(tree, picture, mix)
    given = {"Defocus": source.outputs.get("Defocus"), "Bokeh": source.outputs.get("Bokeh")}
    # Without our passes the whole picture is the base.
    if given["Defocus"] is None or not given["Defocus"].enabled:
        given = {"Defocus": picture, "Bokeh": None}
    for name, socket in given.items():
        changed |= _feed(tree, mix.inputs[name], socket, source)
    return changed | _end_in(tree, mix.outputs["Image"], source), _untold(mix)


def wire_picture(scene, path, is_sequence=False):
    """Send a picture file, such as a refocused one, through a scene's compositing group.

    Parameters
    ----------
    scene : bpy.types.Scene
    path : str
        As Blender keeps it, of the first frame of a sequence.
    is_sequence : bool
        Frames of the scene's range, numbered as the file is.

    Returns
    -------
    changed : bool
    notes : list of str
        What the user has to do, one sentence each.

    Raises
    ------
    RuntimeError
        If Blender cannot read the file.
    """
    image = bpy.data.images.load(path, check_existing=True)
    changed = _switch_on(scene)
    tree = scene.compositing_node_group
    node = next((n for n in tree.nodes if n.type == "IMAGE" and n.image == image), None)
    if node is None:
        node = tree.nodes.new("CompositorNodeImage")
        node.image = image
        node.location = _place_before(tree)
        changed = True
    if is_sequence and image.source != "SEQUENCE":
        image.source = "SEQUENCE"
        changed = True
    if is_sequence:
        frames = scene.frame_end - scene.frame_start + 1
        wanted = (scene.frame_start, scene.frame_start - 1, frames, True)
        names = ("frame_start", "frame_offset", "frame_duration", "use_auto_refresh")
        for name, value in zip(names, wanted, strict=True):
            if getattr(node, name) != value:
                setattr(node, name, value)
                changed = True
    return changed | _end_in(tree, node.outputs["Image"], None), _untold(node)


def _switch_on(scene):
    """Give a scene a compositing group with a Group Output, in use."""
    changed = False
    tree = scene.compositing_node_group
    if tree is None:
        tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        scene.compositing_node_group = tree
        changed = True
    if not any(socket.in_out == "OUTPUT" for socket in _interface(tree)):
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        changed = True
    if _group_output(tree) is None:
        tree.nodes.new("NodeGroupOutput").location = (3.0 * _STEP, 0.0)
        changed = True
    if not scene.render.use_compositing:
        scene.render.use_compositing = True
        changed = True
    return changed


def _interface(tree):
    return [item for item in tree.interface.items_tree if item.item_type == "SOCKET"]


def _group_output(tree):
    found = [node for node in tree.nodes if node.type == "GROUP_OUTPUT"]
    return next((node for node in found if node.is_active_output), next(iter(found), None))


def _render_layers(tree, scene, view_layer):
    for node in tree.nodes:
        if node.type == "R_LAYERS" and node.scene == scene and node.layer == view_layer.name:
            return node, False
    node = tree.nodes.new("CompositorNodeRLayers")
    node.scene, node.layer = scene, view_layer.name
    node.location = _place_before(tree)
    return node, True


def _mix_of(tree, source):
    """Return the Mix that a Render Layers node feeds, or that nothing feeds; or a new one."""
    for node in tree.nodes:
        if node.type == "GROUP" and is_ours(node.node_tree, MIX):
            feeders = {link.from_node for link in node.inputs["Defocus"].links}
            if feeders <= {source}:
                return node, False
    node = tree.nodes.new("CompositorNodeGroup")
    node.node_tree = node_group(MIX)
    node.width = 200.0
    node.location = (source.location.x + 1.5 * _STEP, source.location.y)
    return node, True


def _take_over(tree, picture, mix):
    """Have a Mix feed all that a picture's socket has fed."""
    for link in list(picture.links):
        if link.to_node != mix:
            tree.links.new(mix.outputs["Image"], link.to_socket)


def _feed(tree, target, socket, source):
    """Link a socket of a node to one of a Mix; None: nothing of that node. Whether it was not yet.

    With another engine another socket is due: the whole picture, or the part without highlights.
    """
    links = [link for link in target.links if link.from_node == source]
    if [link.from_socket for link in links] == ([socket] if socket else []):
        return False
    for link in links:
        tree.links.remove(link)
    if socket is not None:
        tree.links.new(socket, target)
    return True


def _end_in(tree, socket, source):
    """Link a socket to the Group Output, unless the user has linked something else there."""
    target = _group_output(tree).inputs[0]
    if target.is_linked:
        before = target.links[0].from_node
        plain = before.type in {"R_LAYERS", "IMAGE"} and before not in (source, socket.node)
        if not plain or source is not None:
            return False
    tree.links.new(socket, target)
    return True


def _untold(node):
    """Return a warning if a node is not connected to the Group Output."""
    waiting, seen = [node], set()
    while waiting:
        one = waiting.pop()
        if one.type == "GROUP_OUTPUT":
            return []
        if one not in seen:
            seen.add(one)
            waiting += [link.to_node for socket in one.outputs for link in socket.links]
    return [f"node '{node.name}' is not linked to the Group Output, which has something else"]


def _place_before(tree):
    """Return a free place, left of all that there is."""
    if not tree.nodes:
        return (0.0, 0.0)
    left = min(node.location.x for node in tree.nodes)
    top = max(node.location.y for node in tree.nodes)
    return (left - 1.5 * _STEP, top)
