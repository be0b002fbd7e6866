"""Walking Blender's node trees: reroutes, muted nodes and groups are followed through.

A place in a tree is a socket and the group nodes that enclose it, outermost first.
"""


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
