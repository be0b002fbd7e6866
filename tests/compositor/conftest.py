"""Pictures through compositing nodes, as a background render gives them."""

import numpy as np
import pytest

from tests.pictures import render_picture

SIZE = (48, 32)


@pytest.fixture
def scene(aplanat_bpy, empty_scene, camera):
    """A scene that Cycles renders at once; what counts are its compositing nodes."""
    scene = empty_scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    return scene


@pytest.fixture
def nodes(aplanat_bpy, scene):
    """Make nodes; `through(build)` renders what `build(tree)` returns, bottom row first."""
    return Nodes(aplanat_bpy, scene)


class Nodes:
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
        node = tree.nodes.new("CompositorNodeGroup")
        node.node_tree = group
        for name, socket in links.items():
            tree.links.new(socket, node.inputs[name])
        for name, value in values.items():
            node.inputs[name.replace("_", " ")].default_value = value
        return node

    def through(self, build):
        tree = self._bpy.data.node_groups.new("Test", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        last = tree.nodes.new("NodeGroupOutput")
        tree.links.new(build(tree), last.inputs[0])
        self._scene.compositing_node_group = tree
        return render_picture(self._scene)[::-1]


@pytest.fixture
def noise():
    """A picture of random colours and alpha, some brighter than 1."""
    pixels = 3.0 * np.random.default_rng(1).random((SIZE[1], SIZE[0], 4), np.float32)
    pixels[..., 3] /= 3.0
    return pixels
