"""Readers of Blender's nodes that look up images."""

import math
from pathlib import Path

import bpy

from ...snapshot.surface_graph import MISSING_IMAGE_COLOR, Constant, Link
from ..images import color_spaces, ies_file
from ..images.tiles import columns_of
from ..skies.sky_image import Sky, sky_xyz
from .tree_reader import input_socket, reader_registry

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
    table = ()
    if use.tiles:
        columns = columns_of(len(use.tiles))
        rows = -(-len(use.tiles) // columns)
        settings += (("grid", f"{columns}, {rows}"),)
        table = tuple(tuple(map(float, tile)) for tile in use.tiles)
    return reader.add("image_texture", inputs, settings, use.uid, table)


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


@reads("TEX_SKY")
def _sky_texture(reader, node, groups):
    use = sky_use(reader, node)
    if use is None:
        return {"Color": Constant(MISSING_IMAGE_COLOR)}
    # With the sun's disc Blender hides the input, and reads nothing of it.
    if input_socket(node, "Vector").enabled and reader.linked(node, "Vector", groups):
        vector = reader.value(node, "Vector", groups)
    else:
        vector = Link(reader.add("generated"), "Generated")
    settings = (("projection", "SKY"), ("interpolation", "Linear"))
    found = reader.add("image_texture", [("Vector", vector)], settings, use.uid)
    return {"Color": Link(found, "Color")}


def sky_use(reader, node):
    """Return the `ImageUse` of a Sky Texture's sky, which is computed where it is new.

    Parameters
    ----------
    reader : TreeReader
    node : bpy.types.ShaderNodeTexSky

    Returns
    -------
    ImageUse or None
        None to draw magenta.
    """
    sky, space = _sky(node), color_spaces.working_space()
    return reader.computed_image(
        (sky, space), "sky", lambda: color_spaces.from_xyz(sky_xyz(sky), space)
    )


def _sky(node):
    if node.sky_type in {"PREETHAM", "HOSEK_WILKIE"}:
        return Sky(
            node.sky_type,
            tuple(node.sun_direction.normalized()),
            turbidity=node.turbidity,
            albedo=node.ground_albedo,
        )
    # The sun rises over +y, and turns clockwise.
    up, turn = node.sun_elevation, node.sun_rotation
    across = math.cos(up)
    return Sky(
        node.sky_type,
        (across * math.sin(turn), across * math.cos(turn), math.sin(up)),
        node.air_density,
        node.aerosol_density,
        node.ozone_density,
        node.altitude,
        node.sun_size if node.sun_disc else 0.0,
        node.sun_intensity,
    )


@reads("TEX_IES")
def _photometric_texture(reader, node, groups):
    text = _photometric_text(node)
    use = None
    if text is not None:
        try:
            use = reader.computed_image(("ies", text), "ies", lambda: ies_file.picture(text))
        except ValueError as error:
            reader.note(f"node '{node.bl_label}' cannot be read: {error}; 0 is used")
    if use is None:
        # As Cycles draws a lamp without a file.
        return {"Fac": Constant((0.0,))}
    if reader.linked(node, "Vector", groups):
        vector = reader.value(node, "Vector", groups)
    else:
        vector = Link(reader.add("generated"), "Generated")
    settings = (("projection", "IES"), ("interpolation", "Linear"), ("extension", "EXTEND"))
    found = Link(reader.add("image_texture", [("Vector", vector)], settings, use.uid), "Color")
    strength = reader.value(node, "Strength", groups)
    product = [("a", found), ("b", strength), ("c", Constant((0.0,)))]
    return {"Fac": Link(reader.add("math", product, _TIMES), "Value")}


_TIMES = (("operation", "MULTIPLY"), ("clamp", ""))


def _photometric_text(node):
    """Return the text of a photometric file, or None."""
    if node.mode == "INTERNAL":
        return node.ies.as_string() if node.ies else None
    try:
        path = bpy.path.abspath(node.filepath, library=node.id_data.library)
        return Path(path).read_text(encoding="latin-1")
    except OSError:
        return None


def _sampling(node, use, extension):
    # As in Cycles, smart interpolation is a cubic one.
    interpolation = "Cubic" if node.interpolation == "Smart" else node.interpolation
    return (
        ("interpolation", interpolation),
        ("extension", extension),
        ("encoding", "srgb" if use.srgb else ""),
        ("associated", "1" if use.associated else ""),
    )
