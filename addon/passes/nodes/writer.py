"""What node generators write into: code, constants, images and attributes of one surface."""

from dataclasses import dataclass, field

import numpy as np

from ...device.geometry import attribute_identifier
from ...snapshot.surface_graph import Constant, Link

_ATTRIBUTE_COMPONENTS = {
    **{"normal": 3, "generated": 3, "tangent": 4, "uv": 2, "color": 4},
    **{"pointiness": 2, "island": 2, "barycentric": 2, "lowest": 3, "highest": 3},
}


@dataclass
class Writer:
    """Collects the code, constants, images and attributes that node generators write.

    Attributes
    ----------
    available : frozenset of str
        Attributes that the mesh has.
    used : frozenset of (int, str)
        Node and output of all links of the graph.
    luminance : tuple of 3 float
        Weights with which a colour becomes a value.
    lines, closure_lines : list of str
        Statements that compute values, and those that put closures together after them.
    bsdfs : int
        How many closures are lit: `lit_closure` has filled as many parameter structs.
    transmitting, dark : set of str
        Closures that may be transparent, and those that add no light of their own.
    glows : bool
    filters : bool
        Some closure lets colours pass unevenly, or more light than there is.
    straight : bool
        Glass lets light pass as if it were thin.
    refracts : bool
        Some closure shows what is behind it bent.
    reads_place : bool
        The code reads the position in object space.
    features : set of str
        Defines of rarer parts of the closures, which other shaders are compiled without.
    """

    available: frozenset[str]
    used: frozenset[tuple[int, str]]
    luminance: tuple[float, float, float]
    straight: bool = False
    lines: list[str] = field(default_factory=list)
    closure_lines: list[str] = field(default_factory=list)
    bsdfs: int = 0
    constants: list[tuple[float, ...]] = field(default_factory=list)
    attributes: list[str] = field(default_factory=list)
    images: list[int] = field(default_factory=list)
    transmitting: set[str] = field(default_factory=set)
    dark: set[str] = field(default_factory=set)
    glows: bool = False
    filters: bool = False
    refracts: bool = False
    reads_place: bool = False
    features: set[str] = field(default_factory=set)
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

    def filter(self, *colors):
        """Note the colours that light takes on by passing: grey of at most 1 is none."""
        even = (isinstance(c, Constant) and len(set(c.value[:3])) == 1 for c in colors)
        limited = (isinstance(c, Constant) and max(c.value[:3]) <= 1.0 for c in colors)
        self.filters = self.filters or not (all(even) and all(limited))

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

    def normal(self):
        """Note that the code reads the normal; a mesh may lack it."""
        if "normal" in self.available:
            self.attribute("normal")

    def place(self):
        """Return the varying of the position in object space."""
        self.reads_place = True
        return "v_object_position"

    def given_normal(self, node, as_given=False):
        """Return the normal that feeds a node, or the surface's own.

        Parameters
        ----------
        node : ShaderNode
        as_given : bool
            Of any length.
        """
        given = dict(node.inputs).get("Normal")
        if given is None:
            return "point_normal()"
        normal = self.value(given, "vec3")
        return normal if as_given else f"unit_or({normal}, vec3(0.0))"

    def lit_closure(self, output, kind, members):
        """Write a closure that reflects light and return it as the one output of a node.

        Only its parameters are written here: all lit closures of a surface are evaluated by one
        piece of code, so that a shader compiles in linear time in their number.

        Parameters
        ----------
        output : str
        kind : str
            ``BSDF_DIFFUSE`` and so on, see lib/surface/bsdf_inputs_lib.glsl.
        members : dict of str to str
            Expressions by member of the parameter struct.
        """
        self.normal()
        number = self.bsdfs
        self.bsdfs += 1
        self.lines.append(f"  bsdfs[{number}] = bsdf_of_kind({kind});")
        for member, expression in members.items():
            self.lines.append(f"  bsdfs[{number}].{member} = {expression};")
        return {output: ("closure", f"lit[{number}]")}

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

    def let_closure(self, expression):
        """Write a closure as a local variable and return its name."""
        name = f"c{len(self.closure_lines)}"
        self.closure_lines.append(f"  Closure {name} = {expression};")
        return name

    def closure(self, output, expression):
        """Write a closure and return it as the one output of a node."""
        return {output: ("closure", self.let_closure(expression))}

    def body(self, surface):
        """Return the statements of ``surface_closure()``.

        Parameters
        ----------
        surface : str
            The closure that is the surface.
        """
        lines = self.lines
        if self.bsdfs:
            # A count that the compiler does not know keeps it from repeating the body.
            count = "1"
            if self.bsdfs > 1:
                self.constants.append((float(self.bsdfs), 0.0, 0.0, 0.0))
                count = f"int(material_buf.constants[{len(self.constants) - 1}].x)"
            lines = [
                f"  Bsdf bsdfs[{self.bsdfs}];",
                f"  Closure lit[{self.bsdfs}];",
                *lines,
                f"  for (int i = 0; i < {count}; i++) {{",
                "    lit[i] = closure_lit(bsdfs[i]);",
                "  }",
            ]
        return "\n".join([*lines, *self.closure_lines, f"  return {surface};"])


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
