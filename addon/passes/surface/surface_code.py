"""From a `SurfaceGraph` to GLSL: one function `surface_closure()` a tree shape.

Constants become members of a uniform block and images become samplers, both numbered in graph
order, so graphs of one shape generate the same text and share one compiled shader.
"""

from dataclasses import dataclass, field

import numpy as np

from ...device.geometry import attribute_identifier
from ...snapshot.surface_graph import Constant, Link
from . import surface_nodes, surface_values

_GENERATORS = surface_nodes.GENERATORS | surface_values.GENERATORS
_ATTRIBUTE_COMPONENTS = {"normal": 3, "generated": 3, "uv": 2, "color": 4}


@dataclass(frozen=True)
class SurfaceCode:
    """Generated code and what to bind for it.

    Parameters
    ----------
    source : str
        Declares ``Closure surface_closure()``.
    constants : tuple of 4-tuples of float
        The material's uniform block, one vec4 a constant.
    attributes : tuple of str
        Mesh attributes that the code reads, such as ``"uv:UVMap"``.
    images : tuple of int
        `ImageSnapshot.uid` of samplers ``image_0_tx``, ``image_1_tx``, ...
    transparent : bool
        The surface may be transparent somewhere. Opaque ones keep the early depth test.
    lit : bool
        The surface reflects lights and the world.
    glows : bool
        The surface may emit where it is transparent, so that its light must be added for every
        sample and not only for those that find it opaque.
    libraries : tuple of str
        Shader files below ``gpu_shaders/`` that the code calls, besides those of every surface.
    """

    source: str
    constants: tuple[tuple[float, ...], ...]
    attributes: tuple[str, ...]
    images: tuple[int, ...]
    transparent: bool
    lit: bool = False
    glows: bool = False
    libraries: tuple[str, ...] = ()


@dataclass
class Writer:
    """Collects the code, constants, images and attributes that node generators write.

    Attributes
    ----------
    available : frozenset of str
        Attributes that the mesh has.
    luminance : tuple of 3 float
        Weights with which a colour becomes a value.
    transmitting, dark : set of str
        Closures that may be transparent, and those that add no light of their own.
    glows : bool
    """

    available: frozenset[str]
    used: frozenset[tuple[int, str]]
    luminance: tuple[float, float, float]
    lines: list[str] = field(default_factory=list)
    constants: list[tuple[float, ...]] = field(default_factory=list)
    attributes: list[str] = field(default_factory=list)
    images: list[int] = field(default_factory=list)
    transmitting: set[str] = field(default_factory=set)
    dark: set[str] = field(default_factory=set)
    lit: bool = False
    glows: bool = False
    # (type, expression) of each output of each node so far
    outputs: list[dict[str, tuple[str, str]]] = field(default_factory=list)

    def value(self, source, wanted):
        """Return a GLSL expression of type `wanted` for an input."""
        if isinstance(source, Constant):
            return self._constant(source.value, wanted)
        if isinstance(source, Link):
            kind, expression = self.outputs[source.node][source.output]
            return convert(kind, expression, wanted, self.luminance)
        raise TypeError(f"not an input: {source!r}")

    def _constant(self, value, wanted):
        index = len(self.constants)
        if wanted == "float" and len(value) > 1:
            value = (float(np.dot(value[:3], self.luminance)),)
        padded = tuple(np.resize(value, 3)) if len(value) == 1 else tuple(value[:3])
        self.constants.append((*map(float, padded), 0.0))
        expression = f"material_buf.constants[{index}]"
        return expression + (".x" if wanted == "float" else ".xyz")

    def table(self, rows):
        """Add rows of 4 numbers to the constants and return the place of the first."""
        first = len(self.constants)
        self.constants += rows
        return first

    def attribute(self, key):
        """Return the varying of a mesh attribute, or zero where the mesh lacks it."""
        components = _ATTRIBUTE_COMPONENTS[key.partition(":")[0]]
        if key not in self.available:
            return f"vec{components}(0.0)"
        if key not in self.attributes:
            self.attributes.append(key)
        return f"v_{attribute_identifier(key)}"

    def light(self):
        """Note that the surface is lit: it reads the normal, where the mesh has one."""
        self.lit = True
        if "normal" in self.available and "normal" not in self.attributes:
            self.attributes.append("normal")

    def image(self, uid):
        """Return the sampler of an image."""
        if uid not in self.images:
            self.images.append(uid)
        return f"image_{self.images.index(uid)}_tx"

    def uses(self, node, output):
        """Whether anything reads an output of the node that is being written."""
        return (len(self.outputs), output) in self.used

    def let(self, kind, expression):
        """Write a local variable and return its name."""
        name = f"t{len(self.lines)}"
        self.lines.append(f"  {kind} {name} = {expression};")
        return name

    def closure(self, output, expression):
        """Write a closure and return it as the one output of a node."""
        return {output: ("closure", self.let("Closure", expression))}


def convert(kind, expression, wanted, luminance):
    """Convert between socket types as Blender's nodes do."""
    if kind == wanted:
        return expression
    if wanted == "vec3" and kind == "float":
        return f"vec3({expression})"
    if wanted == "float" and kind == "color":
        weights = ", ".join(map(str, luminance))
        return f"dot({expression}, vec3({weights}))"
    if wanted == "float" and kind == "vec3":
        return f"dot({expression}, vec3(1.0 / 3.0))"
    if {kind, wanted} <= {"color", "vec3"}:
        return expression
    raise TypeError(f"no conversion from {kind} to {wanted}")


def generate(graph, available):
    """Generate the code of a surface.

    Parameters
    ----------
    graph : SurfaceGraph
    available : iterable of str
        Attributes that the mesh has.

    Returns
    -------
    SurfaceCode
    """
    links = [value for node in graph.nodes for _, value in node.inputs if isinstance(value, Link)]
    used = frozenset((link.node, link.output) for link in links)
    writer = Writer(frozenset(available), used, graph.luminance)
    for node in graph.nodes:
        writer.outputs.append(_GENERATORS[node.kind](node, writer))
    computes = any(node.kind in surface_values.GENERATORS for node in graph.nodes)
    surface = "closure_none()"
    if graph.surface is not None:
        surface = writer.value(graph.surface, "closure")
    body = "\n".join([*writer.lines, f"  return {surface};"])
    return SurfaceCode(
        f"Closure surface_closure()\n{{\n{body}\n}}\n",
        tuple(writer.constants) or ((0.0,) * 4,),
        tuple(writer.attributes),
        tuple(writer.images),
        transparent=surface in writer.transmitting,
        lit=writer.lit,
        glows=writer.glows and surface in writer.transmitting,
        libraries=surface_values.LIBRARIES if computes else (),
    )
