"""All readers of Blender's nodes, by Blender's name of the kind of node."""

from . import (
    closure_nodes,
    fibre_nodes,
    image_nodes,
    input_nodes,
    pattern_nodes,
    value_nodes,
    vector_nodes,
    volume_nodes,
)

READERS = (
    closure_nodes.READERS
    | fibre_nodes.READERS
    | image_nodes.READERS
    | input_nodes.READERS
    | pattern_nodes.READERS
    | value_nodes.READERS
    | vector_nodes.READERS
    | volume_nodes.READERS
)
