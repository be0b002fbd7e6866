"""Readers of Blender's nodes that look up images."""

from ...snapshot.surface_graph import MISSING_IMAGE_COLOR, Constant, Link
from .tree_reader import reader_registry

READERS, reads = reader_registry()


@reads("TEX_IMAGE")
def _image_texture(reader, node, groups):
    if node.image is None:
        # As Cycles draws a node without image; EEVEE draws it in black.
        return {"Color": Constant(MISSING_IMAGE_COLOR), "Alpha": Constant((1.0,))}
    use = reader.use_image(node)
    if use is None:
        return {"Color": Constant(MISSING_IMAGE_COLOR), "Alpha": Constant((1.0,))}
    if node.projection != "FLAT":
        reader.note(f"{node.projection.lower()} projection of an image is drawn flat")
    interpolation = node.interpolation
    if interpolation in {"Cubic", "Smart"}:
        reader.note("cubic interpolation of an image is drawn as linear")
        interpolation = "Linear"
    if reader.linked(node, "Vector", groups):
        vector = reader.value(node, "Vector", groups)
    else:
        vector = Link(reader.add("uv"), "UV")
    settings = (
        ("interpolation", interpolation),
        ("extension", node.extension),
        ("encoding", "srgb" if use.srgb else ""),
        ("associated", "1" if use.associated else ""),
    )
    return reader.add("image_texture", [("Vector", vector)], settings, use.uid)
