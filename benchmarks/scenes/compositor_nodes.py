"""Pictures through compositing nodes, as a background render gives them."""

import numpy as np

from .pictures import render_picture


class Nodes:
    """Makes compositing nodes of a scene.

    Parameters
    ----------
    bpy : module
    scene : bpy.types.Scene
    """

    def __init__(self, bpy, scene):
        self._bpy, self._scene = bpy, scene

    def image(self, tree, pixels):
        """Return the socket of an image with these pixels."""
        height, width = pixels.shape[:2]
        image = self._bpy.data.images.new(
            "pixels", width, height, alpha=True, float_buffer=True, is_data=True
        )
        image.alpha_mode = "CHANNEL_PACKED"
        image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
        image.update()
        image.pack()
        node = tree.nodes.new("CompositorNodeImage")
        node.image = image
        return node.outputs[0]

    def group(self, tree, group, links, **values):
        """Return a node of a group; `links` are sockets, `values` numbers, by input."""
        node = tree.nodes.new("CompositorNodeGroup")
        node.node_tree = group
        for name, socket in links.items():
            tree.links.new(socket, node.inputs[name])
        for name, value in values.items():
            node.inputs[name.replace("_", " ")].default_value = value
        return node

    def through(self, build):
        """Render what `build(tree)` returns; (height, width, 4), bottom row first."""
        tree = self._bpy.data.node_groups.new("Test", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        last = tree.nodes.new("NodeGroupOutput")
        tree.links.new(build(tree), last.inputs[0])
        self._scene.compositing_node_group = tree
        return render_picture(self._scene)[::-1]
