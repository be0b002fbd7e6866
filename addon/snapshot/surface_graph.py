"""A surface or world shader as a value: the nodes that reach the output, in evaluation order.

The reader of Blender's node trees makes these; `passes.nodes.surface_code` turns one into GLSL.
Constants are kept apart from the shape, so that dragging a slider never compiles a shader.
"""

from dataclasses import dataclass

# ITU-R BT.709, the working space that Blender starts with.
REC709_LUMINANCE = (0.212639, 0.715169, 0.072192)


@dataclass(frozen=True)
class Constant:
    """An unlinked input: 1 float or a vector of 3."""

    value: tuple[float, ...]


@dataclass(frozen=True)
class Link:
    """An input fed by an earlier node of the graph."""

    node: int
    output: str


@dataclass(frozen=True)
class ShaderNode:
    """One node.

    Parameters
    ----------
    kind : str
        Which code to generate, such as ``"emission"``.
    inputs : tuple of (str, Constant or Link)
        By socket identifier.
    settings : tuple of (str, str)
        Choices that change the code: attribute names, interpolation, blend types.
    image : int
        `ImageSnapshot.uid` of the node's image, 0 without one.
    table : tuple of tuples of 4 float
        Values of a colour ramp or of curves at evenly spaced places from 0 to 1.
    """

    kind: str
    inputs: tuple[tuple[str, Constant | Link], ...] = ()
    settings: tuple[tuple[str, str], ...] = ()
    image: int = 0
    table: tuple[tuple[float, ...], ...] = ()

    def input(self, name):
        """Return the input called `name`."""
        return dict(self.inputs)[name]

    def setting(self, name, default=""):
        """Return the setting called `name`."""
        return dict(self.settings).get(name, default)


@dataclass(frozen=True)
class SurfaceGraph:
    """Nodes in evaluation order and the closure that is the surface.

    Parameters
    ----------
    nodes : tuple of ShaderNode
        A node's links point to earlier nodes only.
    surface : Link or None
        The closure; None is a surface that emits and reflects nothing.
    luminance : tuple of 3 float
        Luminance weights of the file's working space, with which a colour becomes a value.
    """

    nodes: tuple[ShaderNode, ...] = ()
    surface: Link | None = None
    luminance: tuple[float, float, float] = REC709_LUMINANCE


# Closures whose light depends on the normal.
LIT_KINDS = frozenset(
    {
        *("diffuse", "glossy", "principled", "translucent", "metallic", "glass"),
        *("sheen", "toon", "hair", "fog"),
    }
)
_NORMAL_KINDS = LIT_KINDS | {
    *("geometry", "texture_coordinate", "fresnel", "layer_weight", "tangent", "bump", "normal_map"),
    "displacement",
}
_GENERATED_KINDS = frozenset({"generated", "geometry", "tangent"})


def attributes_read(graph):
    """Return the mesh attributes that a graph may read.

    Parameters
    ----------
    graph : SurfaceGraph

    Returns
    -------
    frozenset of str
        ``"normal"``, ``"generated"``, ``"uv:NAME"``, ``"tangent:NAME"`` of a UV map,
        ``"color:NAME"``, ``"pointiness"``, ``"island"`` (a random number), ``"barycentric"``,
        ``"lowest"`` and ``"highest"`` (corners of the mesh's box); an empty NAME is the active
        one. A node that reads an attribute of any kind by its name gives both keys; meshes
        need only have those that exist.
    """
    keys = set()
    for node in graph.nodes:
        name = node.setting("name")
        if node.kind in _NORMAL_KINDS or node.setting("projection") == "BOX":
            keys.add("normal")
        if node.kind in _GENERATED_KINDS:
            keys.add("generated")
        if (node.kind, node.setting("space")) == ("normal_map", "TANGENT") or (
            node.kind == "tangent" and not node.setting("axis")
        ):
            keys.add(f"tangent:{name}")
        elif node.kind == "fog":
            keys |= {"lowest", "highest"}
        elif node.kind in {"pointiness", "island"}:
            keys.add(node.kind)
        elif node.kind in {"wireframe", "parametric"}:
            keys.add("barycentric")
        elif node.kind == "hair":
            keys.add("tangent:")
        elif node.kind == "uv":
            keys.add(f"uv:{name}")
        elif node.kind == "color_attribute":
            keys.add(f"color:{name}")
        elif node.kind == "attribute":
            keys |= {f"uv:{name}", f"color:{name}"}
        elif node.kind == "image_texture" and "Vector" not in dict(node.inputs):
            keys.add("uv:")
    return frozenset(keys)


# What Blender 5.2 draws where a surface has no material: the Principled BSDF as it is added.
DEFAULT_GRAPH = SurfaceGraph(
    (
        ShaderNode(
            "principled",
            (
                ("Base Color", Constant((0.8, 0.8, 0.8))),
                ("Metallic", Constant((0.0,))),
                ("Roughness", Constant((0.5,))),
                ("IOR", Constant((1.5,))),
                ("Specular IOR Level", Constant((0.5,))),
                ("Specular Tint", Constant((1.0, 1.0, 1.0))),
                ("Emission Color", Constant((1.0, 1.0, 1.0))),
                ("Emission Strength", Constant((0.0,))),
            ),
        ),
    ),
    Link(0, "BSDF"),
)
# Light that is stronger is dropped, and texels as well; the same as in lib/finite_lib.glsl.
LARGEST_RADIANCE = 1e30
# What a missing image looks like in Blender.
MISSING_IMAGE_COLOR = (1.0, 0.0, 1.0)
