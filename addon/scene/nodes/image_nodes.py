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
    if reader.linked(node, "Vector", groups):
        vector = reader.value(node, "Vector", groups)
    else:
        vector = Link(reader.add("uv"), "UV")
    inputs = [("Vector", vector)]
    if node.projection == "BOX":
        inputs.append(("Blend", reader.number(node.projection_blend)))
    settings = (("projection", node.projection), *_sampling(node, use, node.extension))
    return reader.add("image_texture", inputs, settings, use.uid)


@reads("TEX_ENVIRONMENT")
def _environment_texture(reader, node, groups):
    use = reader.use_image(node) if node.image else None
    if use is None:
        return {"Color": Constant(MISSING_IMAGE_COLOR)}
    if reader.linked(node, "Vector", groups):
        vector = reader.value(node, "Vector", groups)
    else:
        vector = Link(reader.add("geometry"), "Position")
    settings = (("projection", node.projection), *_sampling(node, use, "REPEAT"))
    return reader.add("image_texture", [("Vector", vector)], settings, use.uid)


def _sampling(node, use, extension):
    # As in Cycles, smart interpolation is a cubic one.
    interpolation = "Cubic" if node.interpolation == "Smart" else node.interpolation
    return (
        ("interpolation", interpolation),
        ("extension", extension),
        ("encoding", "srgb" if use.srgb else ""),
        ("associated", "1" if use.associated else ""),
    )
