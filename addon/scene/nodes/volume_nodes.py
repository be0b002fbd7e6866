"""Readers of Blender's volume shaders: the same all over, within the box around their mesh.

Coefficients are light lost in a metre: a colour says how much of the density scatters or passes.
"""

from ...snapshot.surface_graph import Constant, Link
from .tree_reader import is_constant, reader_registry

READERS, reads = reader_registry()

_BLACK = Constant((0.0, 0.0, 0.0))
_WHITE = Constant((1.0, 1.0, 1.0))


def _vector(reader, operation, a, b):
    inputs = [("a", a), ("b", b), ("c", _BLACK), ("scale", Constant((1.0,)))]
    return Link(reader.add("vector_math", inputs, (("operation", operation),)), "Vector")


def _fog(reader, node, groups, absorbed, scattered, emitted=_BLACK):
    if getattr(node, "phase", "HENYEY_GREENSTEIN") != "HENYEY_GREENSTEIN":
        reader.note(f"node '{node.bl_label}' scatters by Henyey and Greenstein's phase function")
    inputs = [("Absorption", absorbed), ("Scatter", scattered), ("Emission", emitted)]
    turn = Constant((0.0,))
    if any(socket.identifier == "Anisotropy" for socket in node.inputs):
        turn = reader.value(node, "Anisotropy", groups)
    return Link(reader.add("fog", [*inputs, ("Anisotropy", turn)]), "Volume")


@reads("VOLUME_ABSORPTION")
def _absorption(reader, node, groups):
    color, density = (reader.value(node, name, groups) for name in ("Color", "Density"))
    absorbed = _vector(reader, "MULTIPLY", _vector(reader, "SUBTRACT", _WHITE, color), density)
    return _fog(reader, node, groups, absorbed, _BLACK)


@reads("VOLUME_SCATTER")
def _scatter(reader, node, groups):
    color, density = (reader.value(node, name, groups) for name in ("Color", "Density"))
    return _fog(reader, node, groups, _BLACK, _vector(reader, "MULTIPLY", color, density))


@reads("VOLUME_COEFFICIENTS")
def _coefficients(reader, node, groups):
    names = ("Absorption", "Scatter", "Emission")
    parts = [reader.value(node, f"{name} Coefficients", groups) for name in names]
    return _fog(reader, node, groups, *parts)


@reads("PRINCIPLED_VOLUME")
def _principled_volume(reader, node, groups):
    if not is_constant(reader.value(node, "Blackbody Intensity", groups), 0.0):
        reader.note(f"node '{node.bl_label}' does not glow by its temperature")
    color, density = (reader.value(node, name, groups) for name in ("Color", "Density"))
    scattered = _vector(reader, "MULTIPLY", color, density)
    # What is not scattered is absorbed, less where light of the absorption colour passes.
    kept = _vector(reader, "SUBTRACT", _WHITE, reader.value(node, "Absorption Color", groups))
    lost = _vector(reader, "MULTIPLY", _vector(reader, "SUBTRACT", _WHITE, color), kept)
    absorbed = _vector(reader, "MULTIPLY", lost, density)
    glow, strength = (reader.value(node, f"Emission {n}", groups) for n in ("Color", "Strength"))
    emitted = _vector(reader, "MULTIPLY", glow, strength)
    return _fog(reader, node, groups, absorbed, scattered, emitted)


KINDS = frozenset(READERS)
