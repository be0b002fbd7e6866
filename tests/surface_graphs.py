"""Surface graphs for tests that need no Blender."""

from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph


def emission_graph(color, strength=1.0):
    """Return the graph of one Emission node with constant inputs."""
    node = ShaderNode(
        "emission",
        (("Color", Constant(tuple(color))), ("Strength", Constant((float(strength),)))),
    )
    return SurfaceGraph((node,), Link(0, "Emission"))
