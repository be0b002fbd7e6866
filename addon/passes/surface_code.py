"""From a `SurfaceGraph` to GLSL: one function `surface_closure()` a tree shape.

Constants become members of a uniform block and images become samplers, both numbered in graph
order, so graphs of one shape generate the same text and share one compiled shader.
"""

from dataclasses import dataclass, field

import numpy as np

from ..device.geometry import attribute_identifier
from ..scene.surface_graph import Constant, Link

_ATTRIBUTE_COMPONENTS = {"normal": 3, "uv": 2, "color": 4}


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
        The surface may let light through. Opaque ones keep the early depth test.
    """

    source: str
    constants: tuple[tuple[float, ...], ...]
    attributes: tuple[str, ...]
    images: tuple[int, ...]
    transparent: bool


@dataclass
class Writer:
    """What the node generators write to."""

    available: frozenset[str]
    srgb_images: frozenset[int]
    lines: list[str] = field(default_factory=list)
    constants: list[tuple[float, ...]] = field(default_factory=list)
    attributes: list[str] = field(default_factory=list)
    images: list[int] = field(default_factory=list)
    transparent: bool = False
    # (type, expression) of each output of each node so far
    outputs: list[dict[str, tuple[str, str]]] = field(default_factory=list)

    def value(self, source, wanted):
        """Return a GLSL expression of type `wanted` for an input."""
        if isinstance(source, Constant):
            return self._constant(source.value, wanted)
        if isinstance(source, Link):
            kind, expression = self.outputs[source.node][source.output]
            return convert(kind, expression, wanted)
        raise TypeError(f"not an input: {source!r}")

    def _constant(self, value, wanted):
        index = len(self.constants)
        padded = tuple(np.resize(value, 3)) if len(value) == 1 else tuple(value[:3])
        self.constants.append((*map(float, padded), 0.0))
        expression = f"material_buf.constants[{index}]"
        return expression + (".x" if wanted == "float" else ".xyz")

    def attribute(self, key):
        """Return the varying of a mesh attribute, or zero where the mesh lacks it."""
        components = _ATTRIBUTE_COMPONENTS[key.partition(":")[0]]
        if key not in self.available:
            return f"vec{components}(0.0)"
        if key not in self.attributes:
            self.attributes.append(key)
        return f"v_{attribute_identifier(key)}"

    def image(self, uid):
        """Return the sampler of an image."""
        if uid not in self.images:
            self.images.append(uid)
        return f"image_{self.images.index(uid)}_tx"

    def let(self, kind, expression):
        """Write a local variable and return its name."""
        name = f"t{len(self.lines)}"
        self.lines.append(f"  {kind} {name} = {expression};")
        return name


def convert(kind, expression, wanted):
    """Convert between socket types as Blender's nodes do."""
    if kind == wanted:
        return expression
    if wanted == "vec3" and kind == "float":
        return f"vec3({expression})"
    if wanted == "float" and kind == "color":
        # Rec. 709 luminance
        return f"dot({expression}, vec3(0.2126, 0.7152, 0.0722))"
    if wanted == "float" and kind == "vec3":
        return f"dot({expression}, vec3(1.0 / 3.0))"
    if {kind, wanted} <= {"color", "vec3"}:
        return expression
    raise TypeError(f"no conversion from {kind} to {wanted}")


def _emission(node, writer):
    color = writer.value(node.input("Color"), "vec3")
    strength = writer.value(node.input("Strength"), "float")
    return {"Emission": ("closure", writer.let("Closure", f"closure_emission({color}, {strength})"))}


def _image_texture(node, writer):
    vector = dict(node.inputs).get("Vector")
    if vector is None:
        uv = writer.attribute("uv:")
    else:
        uv = f"({writer.value(vector, 'vec3')}).xy"
    texel = writer.let("vec4", f"texture({writer.image(node.image)}, {uv})")
    if node.image in writer.srgb_images:
        texel = writer.let("vec4", f"vec4(srgb_to_linear({texel}.rgb), {texel}.a)")
    return {"Color": ("color", f"{texel}.rgb"), "Alpha": ("float", f"{texel}.a")}


def _color_attribute(node, writer):
    value = writer.attribute(f"color:{node.setting('name')}")
    return {"Color": ("color", f"{value}.rgb"), "Alpha": ("float", f"{value}.a")}


GENERATORS = {
    "emission": _emission,
    "image_texture": _image_texture,
    "color_attribute": _color_attribute,
}


def generate(graph, available, srgb_images=frozenset()):
    """Generate the code of a surface.

    Parameters
    ----------
    graph : SurfaceGraph
    available : iterable of str
        Attributes that the mesh has.
    srgb_images : frozenset of int
        Images whose texels are sRGB encoded.

    Returns
    -------
    SurfaceCode
    """
    writer = Writer(frozenset(available), srgb_images)
    for node in graph.nodes:
        writer.outputs.append(GENERATORS[node.kind](node, writer))
    surface = "closure_none()"
    if graph.surface is not None:
        surface = writer.value(graph.surface, "closure")
    body = "\n".join([*writer.lines, f"  return {surface};"])
    return SurfaceCode(
        f"Closure surface_closure()\n{{\n{body}\n}}\n",
        tuple(writer.constants) or ((0.0,) * 4,),
        tuple(writer.attributes),
        tuple(writer.images),
        writer.transparent,
    )
