"""Walks one of Blender's node trees and makes the nodes of a `SurfaceGraph`.

A table has a reader for each kind of node (`all_nodes`). A reader
takes a `TreeReader`, a node and the groups around it. It adds a `ShaderNode` and returns its index,
or returns a constant or link for each output, or None where it cannot read the node.
"""

import math

import numpy as np

from ...snapshot.surface_graph import (
    LARGEST_RADIANCE,
    MISSING_IMAGE_COLOR,
    Constant,
    Link,
    ShaderNode,
    SurfaceGraph,
)
from ..images import color_spaces
from .node_tree import source_of

# Samplers beside the lights', their maps', the world's and the instance table's, of the 32 that a
# shader has.
MAX_IMAGES = 23
# What glass reads of its surroundings takes the place of the others.
MAX_IMAGES_OF_GLASS = 18
# Rows of tables, of the 4096 that a uniform block holds at least: room is left for constants.
MAX_TABLE_ROWS = 3584


def _may_be_glass(node):
    if node.type == "BSDF_PRINCIPLED":
        weight = node.inputs["Transmission Weight"]
        return weight.is_linked or weight.default_value > 0.0
    return node.type in {"BSDF_GLASS", "BSDF_REFRACTION"}


def reader_registry():
    """Make a table of readers and the decorator that fills it.

    Returns
    -------
    readers : dict of str to callable
        By Blender's name of the kind of node.
    reads : callable
        ``@reads("EMISSION", ...)``.
    """
    readers = {}

    def reads(*node_types):
        def register(function):
            for node_type in node_types:
                readers[node_type] = function
            return function

        return register

    return readers, reads


class TreeReader:
    """Reads one node tree.

    Parameters
    ----------
    owner : str
        The data-block of the tree, for messages: ``"material 'Floor'"``.
    images : ImageReader
    readers : dict of str to callable
        See `reader_registry`.
    pass_index : int
        Of the material.
    """

    def __init__(self, owner, images, readers, pass_index=0):
        self.owner = owner
        self.pass_index = pass_index
        self.images = images
        self._readers = readers
        self._table_rows = 0
        self.nodes = []
        self.report = []
        self._results = {}
        self._image_uids = set()
        self._most_images = MAX_IMAGES

    def surface(self, output):
        """Return the graph of an output node's Surface socket."""
        if any(_may_be_glass(node) for node in output.id_data.nodes):
            self._most_images = MAX_IMAGES_OF_GLASS
        return self.graph(self.closure(output, "Surface", ()))

    def graph(self, link):
        """Return the nodes so far as a graph with this closure as its surface."""
        return SurfaceGraph(tuple(self.nodes), link, color_spaces.luminance_weights())

    def note(self, text):
        """Add a line to the report, once."""
        line = f"{self.owner}: {text}"
        if line not in self.report:
            self.report.append(line)

    def add(self, kind, inputs=(), settings=(), image=0, table=()):
        """Add a node and return its index."""
        self.nodes.append(ShaderNode(kind, tuple(inputs), tuple(settings), image, table))
        return len(self.nodes) - 1

    def value(self, node, identifier, groups):
        """Return an input's `Constant` or `Link`."""
        socket = input_socket(node, identifier)
        source, inner = source_of(socket, groups)
        if not source.is_output:
            return converted(self.constant(source), source, socket)
        result = self._result(source, inner)
        if result is None:
            self.note(f"node '{source.node.bl_label}' is not read; its socket's value is used")
            return self.constant(socket)
        return converted(result, source, socket)

    def constant(self, socket):
        """Return a socket's own value; 0 in place of NaN."""
        numbers = np.abs(numbers_of(socket))
        if not (numbers <= LARGEST_RADIANCE).all():
            fault = "is not a number; 0 is used"
            if not np.isnan(numbers).any():
                fault = f"is {numbers.max():.3g}; light so strong is left out"
            self.note(f"'{socket.name}' of node '{socket.node.bl_label}' {fault}")
        return constant(socket)

    def linked(self, node, identifier, groups):
        """Whether anything feeds an input."""
        socket = input_socket(node, identifier)
        return socket is not None and source_of(socket, groups)[0].is_output

    def values(self, node, identifiers, groups):
        """Return (identifier, input) pairs."""
        return [(name, self.value(node, name, groups)) for name in identifiers]

    def number(self, value):
        """Return a property of a node as a constant."""
        return Constant((float(value),))

    def normal(self, node, groups):
        """Return the normal that feeds a node as a pair of a list; an empty list without one."""
        if not self.linked(node, "Normal", groups):
            return []
        return self.values(node, ("Normal",), groups)

    def closure(self, node, identifier, groups):
        """Return the link of a shader input, or None where nothing feeds it."""
        source, inner = source_of(input_socket(node, identifier), groups)
        if not source.is_output:
            return None
        if source.type != "SHADER":
            # A colour plugged into a shader socket is drawn as its emission.
            color = self._result(source, inner)
            if color is None:
                self.note(f"node '{source.node.bl_label}' is not read; it is drawn in magenta")
                color = Constant(MISSING_IMAGE_COLOR)
            inputs = [("Color", color), ("Strength", Constant((1.0,)))]
            return Link(self.add("emission", inputs), "Emission")
        result = self._result(source, inner)
        if result is None:
            self.note(f"node '{source.node.bl_label}' is not read; it is drawn in magenta")
            inputs = [("Color", Constant(MISSING_IMAGE_COLOR)), ("Strength", Constant((1.0,)))]
            return Link(self.add("emission", inputs), "Emission")
        return result

    def has_room(self, rows):
        """Reserve rows of a table in the material's constants; False if they do not fit."""
        if self._table_rows + rows > MAX_TABLE_ROWS:
            return False
        self._table_rows += rows
        return True

    def use_image(self, node):
        """Return the `ImageUse` of a node's image, or None to draw magenta."""
        return self._within_limit(self.images.read(node.image, node.image_user))

    def computed_image(self, key, name, compute):
        """Return the `ImageUse` of `ImageReader.computed`, or None to draw magenta."""
        return self._within_limit(self.images.computed(key, name, compute))

    def _within_limit(self, use):
        if use is None:
            return None
        if use.uid not in self._image_uids and len(self._image_uids) == self._most_images:
            self.note(f"uses more than {self._most_images} images; the rest is drawn in magenta")
            return None
        self._image_uids.add(use.uid)
        return use

    def _result(self, output, groups):
        node = output.node
        key = (*(group.as_pointer() for group in groups), node.as_pointer())
        if key not in self._results:
            reader = self._readers.get(node.type)
            self._results[key] = reader(self, node, groups) if reader else None
        result = self._results[key]
        if isinstance(result, Link):
            return result
        if isinstance(result, dict):
            return result.get(output.identifier)
        return None if result is None else Link(result, output.identifier)


def numbers_of(socket):
    """Return the numbers of a socket's own value: 1, or the 3 of a vector or colour."""
    value = getattr(socket, "default_value", 0.0)
    if isinstance(value, bool | int | float):
        return (float(value),)
    try:
        return tuple(float(v) for v in value)[:3]
    except (TypeError, ValueError):
        return (0.0,)


def constant(socket):
    """Return a socket's own value; 0 in place of NaN, as Cycles draws it."""
    return Constant(tuple(0.0 if math.isnan(v) else v for v in numbers_of(socket)))


def constant_number(socket):
    """Return a socket's own value as a number: a colour's luminance, a vector's mean."""
    return _as_number(constant(socket).value, socket)


def converted(value, source, socket):
    """Convert a constant between socket types, as Blender does.

    Parameters
    ----------
    value : Constant or Link
        A link is converted where it is read.
    source, socket : bpy.types.NodeSocket
        The socket that the value comes from, and the input that it feeds.

    Returns
    -------
    Constant or Link
        As many numbers as the input has, converted as Blender does: a number becomes all three of
        a vector or colour, a colour becomes its luminance, a vector its mean.
    """
    if not isinstance(value, Constant) or len(value.value) == len(numbers_of(socket)):
        return value
    if len(value.value) == 1:
        return Constant(value.value * 3)
    return Constant((_as_number(value.value, source),))


def _as_number(values, socket):
    if len(values) == 1:
        return values[0]
    if socket.type == "RGBA":
        return float(np.dot(values, color_spaces.luminance_weights()))
    return float(np.mean(values))


def is_constant(value, *numbers):
    """Whether an input is unlinked and has one of these values."""
    return isinstance(value, Constant) and any(
        all(v == number for v in value.value) for number in numbers
    )


def input_socket(node, identifier):
    """Return the input of a node with this identifier, or None."""
    return next((s for s in node.inputs if s.identifier == identifier), None)
