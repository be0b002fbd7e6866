"""The node groups of the compositor, made by code: the same in a scene and in the asset library.

- **Aplanat Mix** puts the passes Defocus and Bokeh together again, each with its exposure, and lets
  the picture fall off towards its corners as the cosine to the fourth of the field angle does. As
  it comes, its picture is Combined to the last bit.
- **Aplanat Fringe** magnifies red and blue otherwise than green: lateral colour, which grows with a
  power of the distance from the picture's middle.
- **Aplanat Bokeh Sprite** gives the picture of a point out of focus (`sprite_image`) as Blender's
  nodes want it: Bokeh Blur scatters it as it is, Convolve turns its kernel by half a turn.
"""

from collections.abc import Callable
from dataclasses import dataclass

import bpy

MIX, FRINGE, SPRITE = "Aplanat Mix", "Aplanat Fringe", "Aplanat Bokeh Sprite"
# A property of the groups that are ours, with the version of what is in them.
_MARK, _VERSION = "aplanat_group", 1
_TREE = "CompositorNodeTree"


@dataclass(frozen=True)
class NodeGroup:
    """A node group that code makes.

    Parameters
    ----------
    name : str
    description : str
        For tooltips and the asset browser.
    build : callable
        Fills an empty node tree.
    """

    name: str
    description: str
    build: Callable


def node_group(name):
    """Return one of our node groups in the current file; it is made if it is not there.

    A group that somebody has changed stays as it is: what it is called and has does not matter.

    Parameters
    ----------
    name : str
        `MIX`, `FRINGE` or `SPRITE`.

    Returns
    -------
    bpy.types.NodeTree
    """
    for tree in bpy.data.node_groups:
        if is_ours(tree, name) and tree.library is None:
            return tree
    return new_group(name)


def new_group(name):
    """Return a new node group, whatever there is in the current file."""
    group = GROUPS[name]
    tree = bpy.data.node_groups.new(name, _TREE)
    tree.description = group.description
    tree.color_tag = "FILTER"
    tree[_MARK] = f"{name} {_VERSION}"
    group.build(tree)
    _lay_out(tree)
    return tree


def is_ours(tree, name):
    """Whether a node tree is one of our groups."""
    return tree is not None and str(tree.get(_MARK, "")).rpartition(" ")[0] == name


class _Graph:
    """Nodes and links of a tree that is being made."""

    def __init__(self, tree):
        self.tree = tree

    def input(self, name, kind, default=None, limits=None, description=""):
        """Add an input of the group."""
        socket = self.tree.interface.new_socket(
            name, in_out="INPUT", socket_type=f"NodeSocket{kind}", description=description
        )
        if default is not None:
            socket.default_value = default
        if limits is not None:
            socket.min_value, socket.max_value = limits

    def output(self, name, value, description=""):
        """Add an output of the group, and what it gives."""
        self.tree.interface.new_socket(
            name, in_out="OUTPUT", socket_type="NodeSocketColor", description=description
        )
        found = [node for node in self.tree.nodes if node.type == "GROUP_OUTPUT"]
        last = found[0] if found else self.tree.nodes.new("NodeGroupOutput")
        self.tree.links.new(value, last.inputs[name])

    def inputs(self):
        """Return the inputs of the group by name, once all are added."""
        return self.tree.nodes.new("NodeGroupInput").outputs

    def node(self, kind, inputs=None, **options):
        """Add a node; `inputs` by name or number: sockets to link, or values."""
        node = self.tree.nodes.new(kind)
        for name, value in options.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node

    def math(self, operation, *values):
        """Add arithmetic of numbers."""
        return self.node("ShaderNodeMath", dict(enumerate(values)), operation=operation).outputs[0]

    def vectors(self, operation, *values, gives="Vector"):
        """Add arithmetic of vectors."""
        inputs = dict(enumerate(values))
        return self.node("ShaderNodeVectorMath", inputs, operation=operation).outputs[gives]

    def scaled(self, vector, factor):
        """Return a vector times a number."""
        inputs = {0: vector, "Scale": factor}
        return self.node("ShaderNodeVectorMath", inputs, operation="SCALE").outputs[0]

    def colors(self, blend, one, other, factor=1.0):
        """Add arithmetic of colours; alpha is that of the first."""
        # Of the sockets that are called the same, those for colours.
        node = self.node(
            "ShaderNodeMix",
            {0: factor, 6: one, 7: other},
            data_type="RGBA",
            blend_type=blend,
            clamp_factor=False,
        )
        return node.outputs[2]

    def field(self, image):
        """Return where a pixel is: 0 in the middle, length 1 in a corner; and half the diagonal."""
        size = self.node("CompositorNodeImageInfo", {0: image}).outputs["Dimensions"]
        share = self.node("CompositorNodeImageCoordinates", {0: image}).outputs["Normalized"]
        diagonal = self.vectors("LENGTH", size, gives="Value")
        centred = self.vectors("MULTIPLY_ADD", share, (2.0, 2.0, 0.0), (-1.0, -1.0, 0.0))
        place = self.vectors("MULTIPLY", centred, size)
        place = self.scaled(place, self.math("DIVIDE", 1.0, diagonal))
        return place, self.math("MULTIPLY", diagonal, 0.5)


def _build_mix(tree):
    graph = _Graph(tree)
    graph.input("Defocus", "Color", (0.0, 0.0, 0.0, 1.0), description="The pass Defocus")
    graph.input("Bokeh", "Color", (0.0, 0.0, 0.0, 0.0), description="The pass Bokeh")
    stops = (-10.0, 10.0)
    text = "Stops by which {} brighter"
    graph.input("Defocus Exposure", "Float", 0.0, stops, text.format("the base is"))
    graph.input("Bokeh Exposure", "Float", 0.0, stops, text.format("highlights are"))
    text = "Colourfulness of the highlights: 0 is grey, 1 as they are"
    graph.input("Bokeh Saturation", "Float", 1.0, (0.0, 4.0), text)
    text = "Colour that highlights are multiplied by"
    graph.input("Bokeh Tint", "Color", (1.0, 1.0, 1.0, 1.0), description=text)
    text = (
        "Falling-off towards the corners, as the cosine to the fourth of the field angle: the"
        " square of the angle's tangent in the corner; 0 is none"
    )
    graph.input("Vignette", "Float", 0.0, (0.0, 4.0), text)
    given = graph.inputs()
    base = graph.node("CompositorNodeExposure", {0: given[0], 1: given["Defocus Exposure"]})
    light = graph.node("CompositorNodeExposure", {0: given[1], 1: given["Bokeh Exposure"]})
    grey = graph.node("CompositorNodeRGBToBW", {0: light.outputs[0]})
    light = graph.colors("MIX", grey.outputs[0], light.outputs[0], given["Bokeh Saturation"])
    light = graph.colors("MULTIPLY", light, given["Bokeh Tint"])
    picture = graph.colors("ADD", base.outputs[0], light)
    place, _ = graph.field(given[0])
    square = graph.vectors("DOT_PRODUCT", place, place, gives="Value")
    secant = graph.math("MULTIPLY_ADD", square, given["Vignette"], 1.0)
    falloff = graph.math("DIVIDE", 1.0, graph.math("MULTIPLY", secant, secant))
    graph.output("Image", graph.colors("MULTIPLY", picture, falloff))


def _build_fringe(tree):
    graph = _Graph(tree)
    graph.input("Image", "Color", (0.0, 0.0, 0.0, 1.0))
    text = (
        "How far {} is moved away from the middle in the corner, in thousandths of the corner's"
        " distance from it; green stays"
    )
    for name, value in (("Red", 0.5), ("Blue", -0.5)):
        graph.input(name, "Float", value, (-50.0, 50.0), text.format(name.lower()))
    text = (
        "Power of the distance from the middle that the fringes grow with: 1 is an even"
        " magnification, 3 leaves the middle clean"
    )
    graph.input("Field", "Float", 1.0, (1.0, 8.0), text)
    given = graph.inputs()
    image = given[0]
    place, half_diagonal = graph.field(image)
    distance = graph.vectors("LENGTH", place, gives="Value")
    grown = graph.math("POWER", distance, graph.math("SUBTRACT", given["Field"], 1.0))
    unit = graph.math("MULTIPLY", half_diagonal, 0.001)
    shift = graph.scaled(place, graph.math("MULTIPLY", grown, unit))
    green = graph.node("CompositorNodeSeparateColor", {0: image}).outputs
    channels = {"Green": green["Green"], "Alpha": green["Alpha"]}
    for name in ("Red", "Blue"):
        # Edges of the picture go on outside: no dark or coloured margin.
        moved = graph.node(
            "CompositorNodeDisplace",
            {
                "Image": image,
                "Displacement": graph.scaled(shift, given[name]),
                "Extension X": "Extend",
                "Extension Y": "Extend",
            },
        )
        parts = graph.node("CompositorNodeSeparateColor", {0: moved.outputs[0]}).outputs
        channels[name] = parts[name]
    graph.output("Image", graph.node("CompositorNodeCombineColor", channels).outputs[0])


def _build_sprite(tree):
    graph = _Graph(tree)
    image = graph.node("CompositorNodeImage").outputs["Image"]
    turned = graph.node("CompositorNodeFlip", {"Image": image, "Flip X": True, "Flip Y": True})
    graph.output("Bokeh", image, "For the node Bokeh Blur")
    graph.output("Kernel", turned.outputs[0], "For the node Convolve, which turns it round")


def _lay_out(tree):
    """Place nodes in columns: each to the right of all that it needs."""
    column = {}

    def place(node):
        if node not in column:
            before = [link.from_node for link in tree.links if link.to_node == node]
            column[node] = 1 + max((place(other) for other in before), default=-1)
        return column[node]

    rows = {}
    for node in tree.nodes:
        at = place(node)
        node.location = (200.0 * at, -180.0 * rows.get(at, 0))
        rows[at] = rows.get(at, 0) + 1


GROUPS = {
    group.name: group
    for group in (
        NodeGroup(
            MIX,
            "Put Aplanat's passes Defocus and Bokeh together again, with an exposure for each,"
            " colours of the highlights, and vignetting",
            _build_mix,
        ),
        NodeGroup(
            FRINGE,
            "Lateral colour of a lens: red and blue are magnified otherwise than green, more and"
            " more towards the corners",
            _build_fringe,
        ),
        NodeGroup(
            SPRITE,
            "The disc of a point out of focus, as the camera's lens makes it, for the nodes Bokeh"
            " Blur and Convolve",
            _build_sprite,
        ),
    )
}
