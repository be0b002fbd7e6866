"""Reads Blender's materials into `MaterialSnapshot`."""

from ...snapshot.content import MaterialSnapshot, next_uid
from ...snapshot.cryptomatte import cryptomatte_id
from ...snapshot.surface_graph import DEFAULT_GRAPH, Constant, Link, ShaderNode, SurfaceGraph
from ..images.images import ImageReader
from ..nodes import volume_nodes
from ..nodes.all_nodes import READERS
from ..nodes.node_tree import inlined, source_of
from ..nodes.tree_reader import TreeReader, input_socket
from ..nodes.vector_nodes import read_displacement

_INVISIBLE_GRAPH = SurfaceGraph(
    (ShaderNode("transparent", (("Color", Constant((1.0, 1.0, 1.0))),)),), Link(0, "BSDF")
)


_AS_BOX = (
    "node '{}' is drawn as fog that is the same all over the box around its mesh, in front of"
    " what is in it, scattering light once"
)


def _fog(reader, output):
    """Return the link of a material's volume, or None where its nodes are mixed or unknown."""
    source, _ = source_of(input_socket(output, "Volume"), ())
    if not source.is_output or source.node.type not in volume_nodes.KINDS:
        return None
    return reader.closure(output, "Volume", ())


class MaterialReader:
    """Reads materials and the images they use.

    Keep one for the life of an extractor: a material or image that did not change keeps its uid
    from one round to the next.

    Parameters
    ----------
    largest_image : int or None
        Texels along a side that the device can hold.
    in_main_thread : callable or None
        As for `ImageReader`.

    Attributes
    ----------
    materials : dict of int to MaterialSnapshot
        Those read since `begin`.
    images : dict of int to ImageSnapshot
    report : list of str
        Warnings: what is not drawn, and what is drawn instead, one line each.
    """

    def __init__(self, largest_image=None, in_main_thread=None):
        self.image_reader = ImageReader(largest_image, True, in_main_thread)
        self._known = {}
        self.begin()

    def begin(self):
        """Start a new round; materials that the last round did not use are forgotten."""
        used = self.materials.keys() if self._known else ()
        self._known = {k: m for k, m in self._known.items() if m.uid in used}
        self.image_reader.begin()
        self.materials = {}
        self._uids = {}
        self._report = []

    @property
    def images(self):
        """The images read since `begin`."""
        return self.image_reader.images

    @property
    def report(self):
        """The lines of the report since `begin`."""
        return list(dict.fromkeys(self._report + self.image_reader.report))

    def read(self, material):
        """Return the uid of a material, reading it at its first mention in the round.

        Parameters
        ----------
        material : bpy.types.Material or None
            None is what Blender draws where a surface has no material.

        Returns
        -------
        int
        """
        key = material.original.session_uid if material else 0
        uid = self._uids.get(key)
        if uid is None:
            snapshot = self._snapshot(material, self._known.get(key))
            self._known[key] = snapshot
            self.materials[snapshot.uid] = snapshot
            uid = self._uids[key] = snapshot.uid
        return uid

    def _snapshot(self, material, known):
        if material is None:
            name, graph, highlights = "", DEFAULT_GRAPH, True
        else:
            name, graph = material.name, self._graph(material)
            highlights = material.aplanat.highlights != "NEVER"
        if known and (name, graph, highlights) == (known.name, known.graph, known.highlights):
            return known
        matte = cryptomatte_id(name) if name else 0.0
        return MaterialSnapshot(next_uid(), name, graph, matte, highlights)

    def _graph(self, material):
        # The nodes live as long as their tree: `_owner` is kept.
        output, _owner = inlined(material, "EEVEE")
        if output is None:
            return SurfaceGraph()
        owner = f"material '{material.name_full}'"
        reader = TreeReader(owner, self.image_reader, READERS, material.pass_index)
        # First, so that all that follows has the normal that it bends.
        read_displacement(reader, output)
        graph = reader.surface(output)
        if reader.linked(output, "Volume", ()):
            fog = None if graph.surface is not None else _fog(reader, output)
            if fog is not None:
                graph = reader.graph(fog)
                socket, _ = source_of(input_socket(output, "Volume"), ())
                reader.note(_AS_BOX.format(socket.node.bl_label))
            else:
                reader.note("volume is not drawn")
                if graph.surface is None:
                    # The mesh around a volume (fog, smoke) has no surface of its own.
                    graph = _INVISIBLE_GRAPH
        if reader.linked(output, "Displacement", ()) and material.displacement_method != "BUMP":
            reader.note("displacement is drawn as bump")
        if material.use_backface_culling:
            reader.note("backface culling is not done; both sides are drawn, as in Cycles")
        self._report += reader.report
        return graph
