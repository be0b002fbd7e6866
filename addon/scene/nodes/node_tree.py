"""Walking Blender's node trees.

Blender itself resolves groups, reroutes, muted nodes, menus, closures and repeat zones, and
computes what is constant (`inlined`), as it does for its own engines. Where it cannot, groups,
reroutes and muted nodes are followed here: a place in a tree is a socket and the group nodes that
enclose it, outermost first.
"""

import bpy


def inlined(block, target):
    """Return the node tree of a material, world or light as one without groups.

    Parameters
    ----------
    block : bpy.types.Material, bpy.types.World or bpy.types.Light
        Evaluated.
    target : str
        Of the output node that is looked for first, as `ShaderNodeTree.get_output_node` takes it.

    Returns
    -------
    output : bpy.types.Node or None
        The output node.
    owner : object
        To be kept as long as the tree is read.
    """
    if block.node_tree is None:
        return None, None
    own = block.node_tree.get_output_node(target)
    if own is None:
        return None, None
    make = {"Material": "from_material", "World": "from_world"}
    kind = next((kind for kind in make if isinstance(block, getattr(bpy.types, kind))), None)
    method = make.get(kind, "from_light")
    made = getattr(bpy.types.InlineShaderNodes, method)(block)
    output = made.node_tree and made.node_tree.get_output_node(target)
    # Blender resolves nothing where all outputs are of certain engines, and another tree where
    # there are several.
    if not output or output.target != own.target:
        return own, block
    return output, made


def source_of(socket, groups):
    """Follow an input back to the socket that feeds it.

    Parameters
    ----------
    socket : bpy.types.NodeSocket
        An input.
    groups : tuple of bpy.types.Node
        The group nodes that enclose it.

    Returns
    -------
    socket : bpy.types.NodeSocket
        An output of a node that computes something, or the unlinked input whose value is used.
    groups : tuple of bpy.types.Node
    """
    while True:
        link = _live_link(socket)
        if link is None:
            return socket, groups
        output = link.from_socket
        node = output.node
        if node.mute:
            passed = next((i for i in node.internal_links if i.to_socket == output), None)
            if passed is None:
                return socket, groups
            socket = passed.from_socket
        elif node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "GROUP_INPUT" and groups:
            outer = _by_identifier(groups[-1].inputs, output.identifier)
            if outer is None:
                return socket, groups
            socket, groups = outer, groups[:-1]
        elif node.type == "GROUP":
            inner = group_result(node, output.identifier)
            if inner is None or node in groups:
                return socket, groups
            socket, groups = inner, (*groups, node)
        else:
            return output, groups


def group_result(group, identifier):
    """Return the input of a group's output node that gives the group node's output, or None."""
    if group.node_tree is None:
        return None
    for node in group.node_tree.nodes:
        if node.type == "GROUP_OUTPUT" and node.is_active_output:
            return _by_identifier(node.inputs, identifier)
    return None


def _live_link(socket):
    if not socket.is_linked:
        return None
    return next((link for link in socket.links if link.is_valid and not link.is_muted), None)


def _by_identifier(sockets, identifier):
    return next((socket for socket in sockets if socket.identifier == identifier), None)
