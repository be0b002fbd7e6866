"""From a `SurfaceGraph` to GLSL: one function `surface_closure()` a tree shape.

Constants become members of a uniform block and images become samplers, both numbered in graph
order, so graphs of one shape generate the same text and share one compiled shader.
"""

from dataclasses import dataclass

from ...snapshot.brightness import mirrors, reflects
from ...snapshot.surface_graph import Link
from . import closure_nodes, image_nodes, input_nodes, pattern_nodes, value_nodes, vector_nodes
from .writer import Writer

_GENERATORS = (
    closure_nodes.GENERATORS
    | input_nodes.GENERATORS
    | pattern_nodes.GENERATORS
    | value_nodes.GENERATORS
    | vector_nodes.GENERATORS
    | image_nodes.GENERATORS
)


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
    filters : bool
        Light that passes the surface is multiplied by a colour.
    refracts : bool
        What is behind the surface is seen bent, as glass shows it.
    libraries : tuple of str
        Shader files below ``gpu_shaders/`` that the code calls, besides those of every surface.
    reads_place : bool
        The code reads the varying of the position in object space, ``v_object_position``.
    features : tuple of str
        Defines that its closures need.
    mirrors : bool
        Its reflections depend on the place on the lens: see `snapshot.brightness.mirrors`.
    reflects : bool
        It has no light of its own: see `snapshot.brightness.reflects`.
    """

    source: str
    constants: tuple[tuple[float, ...], ...]
    attributes: tuple[str, ...]
    images: tuple[int, ...]
    transparent: bool
    lit: bool = False
    glows: bool = False
    filters: bool = False
    refracts: bool = False
    libraries: tuple[str, ...] = ()
    reads_place: bool = False
    features: tuple[str, ...] = ()
    mirrors: bool = False
    reflects: bool = False


def generate(graph, available, straight=False):
    """Generate the code of a surface.

    Parameters
    ----------
    graph : SurfaceGraph
    available : iterable of str
        Attributes that the mesh has.
    straight : bool
        Glass lets light pass as if it were thin, instead of showing what is behind it.

    Returns
    -------
    SurfaceCode
    """
    links = [value for node in graph.nodes for _, value in node.inputs if isinstance(value, Link)]
    used = frozenset((link.node, link.output) for link in links)
    writer = Writer(frozenset(available), used, graph.luminance, straight)
    libraries = {}
    for node in graph.nodes:
        generator = _GENERATORS[node.kind]
        libraries |= dict.fromkeys(generator.libraries)
        writer.outputs.append(generator.write(node, writer))
    surface = "closure_none()"
    if graph.surface is not None:
        surface = writer.value(graph.surface, "closure")
    body = writer.body(surface)
    return SurfaceCode(
        f"Closure surface_closure()\n{{\n{body}\n}}\n",
        tuple(writer.constants) or ((0.0,) * 4,),
        tuple(writer.attributes),
        tuple(writer.images),
        transparent=surface in writer.transmitting,
        lit=writer.bsdfs > 0,
        glows=writer.glows and surface in writer.transmitting,
        refracts=writer.refracts,
        filters=writer.filters and surface in writer.transmitting,
        libraries=tuple(libraries),
        reads_place=writer.reads_place,
        features=tuple(sorted(writer.features)),
        mirrors=mirrors(graph),
        reflects=reflects(graph),
    )
