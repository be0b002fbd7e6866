"""Blender's node trees to `SurfaceGraph`."""

import numpy as np

from .snapshot import ImageSnapshot, MaterialSnapshot, next_uid
from .surface_graph import (
    DEFAULT_BASE_COLOR,
    MISSING_IMAGE_COLOR,
    Constant,
    Link,
    ShaderNode,
    SurfaceGraph,
    emission_graph,
)


class MaterialReader:
    """Reads materials and the images they use, each once."""

    def __init__(self):
        self.materials = {}
        self.images = {}
        self.report = []
        self._uids = {}
        self._image_uids = {}

    def read(self, material):
        """Return the uid of a material, reading it at its first mention."""
        key = material.as_pointer() if material else 0
        uid = self._uids.get(key)
        if uid is None:
            uid = self._uids[key] = next_uid()
            graph = self._graph(material) if material else emission_graph(DEFAULT_BASE_COLOR)
            name = material.name if material else ""
            self.materials[uid] = MaterialSnapshot(uid, name, graph)
        return uid

    def _graph(self, material):
        output = material.node_tree and material.node_tree.get_output_node("ALL")
        if not output or not output.inputs["Surface"].is_linked:
            return SurfaceGraph()
        nodes = []
        surface = self._node(output.inputs["Surface"].links[0].from_socket, nodes)
        return SurfaceGraph(tuple(nodes), surface)

    def _input(self, socket, nodes):
        if socket.is_linked:
            return self._node(socket.links[0].from_socket, nodes)
        value = socket.default_value
        return Constant((value,) if socket.type == "VALUE" else tuple(value)[:3])

    def _node(self, socket, nodes):
        node = socket.node
        if node.type == "EMISSION":
            inputs = tuple((k, self._input(node.inputs[k], nodes)) for k in ("Color", "Strength"))
            nodes.append(ShaderNode("emission", inputs))
        elif node.type == "TEX_IMAGE":
            nodes.append(ShaderNode("image_texture", image=self._image(node.image)))
        elif node.type == "VERTEX_COLOR":
            nodes.append(ShaderNode("color_attribute", settings=(("name", node.layer_name),)))
        else:
            nodes.append(emission_graph(MISSING_IMAGE_COLOR).nodes[0])
            return Link(len(nodes) - 1, "Emission")
        return Link(len(nodes) - 1, socket.identifier)

    def _image(self, image):
        key = image.as_pointer()
        uid = self._image_uids.get(key)
        if uid is None:
            uid = self._image_uids[key] = next_uid()
            width, height = image.size
            pixels = np.empty((height, width, 4), np.float32)
            image.pixels.foreach_get(pixels.reshape(-1))
            srgb = False
            if not image.is_float:
                pixels = np.rint(pixels * 255.0).astype(np.uint8)
                srgb = image.colorspace_settings.name == "sRGB"
            self.images[uid] = ImageSnapshot(uid, image.name, pixels, srgb)
        return uid
