"""Readers of Blender's procedural textures."""

from ...snapshot.surface_graph import Link
from .tree_reader import reader_registry

READERS, reads = reader_registry()

_NO_MAPPING = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def _place(reader, node, groups):
    """Return the vector that a texture is looked up at, as a pair; generated if none feeds it."""
    mapping = node.texture_mapping
    found = tuple(tuple(v) for v in (mapping.translation, mapping.rotation, mapping.scale))
    if found != _NO_MAPPING:
        reader.note(f"the hidden mapping of node '{node.bl_label}' is not read")
    if reader.linked(node, "Vector", groups):
        return "Vector", reader.value(node, "Vector", groups)
    return "Vector", Link(reader.add("generated"), "Generated")


def _flag(value):
    return "1" if value else ""


@reads("TEX_NOISE")
def _noise(reader, node, groups):
    names = ("W", "Scale", "Detail", "Roughness", "Lacunarity", "Offset", "Gain", "Distortion")
    inputs = [_place(reader, node, groups), *reader.values(node, names, groups)]
    settings = (
        ("dimensions", node.noise_dimensions),
        ("type", node.noise_type),
        ("normalize", _flag(node.normalize)),
    )
    return reader.add("noise", inputs, settings)


@reads("TEX_WHITE_NOISE")
def _white_noise(reader, node, groups):
    inputs = reader.values(node, ("Vector", "W"), groups)
    return reader.add("white_noise", inputs, (("dimensions", node.noise_dimensions),))


@reads("TEX_VORONOI")
def _voronoi(reader, node, groups):
    names = (
        *("W", "Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent"),
        "Randomness",
    )
    inputs = [_place(reader, node, groups), *reader.values(node, names, groups)]
    settings = (
        ("dimensions", node.voronoi_dimensions),
        ("feature", node.feature),
        ("metric", node.distance),
        ("normalize", _flag(node.normalize)),
    )
    return reader.add("voronoi", inputs, settings)


@reads("TEX_WAVE")
def _wave(reader, node, groups):
    names = (
        *("Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness"),
        "Phase Offset",
    )
    inputs = [_place(reader, node, groups), *reader.values(node, names, groups)]
    bands = node.wave_type == "BANDS"
    settings = (
        ("type", node.wave_type),
        ("direction", node.bands_direction if bands else node.rings_direction),
        ("profile", node.wave_profile),
    )
    return reader.add("wave", inputs, settings)


@reads("TEX_MAGIC")
def _magic(reader, node, groups):
    inputs = [_place(reader, node, groups), *reader.values(node, ("Scale", "Distortion"), groups)]
    return reader.add("magic", inputs, (("depth", str(node.turbulence_depth)),))


@reads("TEX_CHECKER")
def _checker(reader, node, groups):
    names = ("Color1", "Color2", "Scale")
    return reader.add(
        "checker", [_place(reader, node, groups), *reader.values(node, names, groups)]
    )


@reads("TEX_BRICK")
def _brick(reader, node, groups):
    names = (
        *("Color1", "Color2", "Mortar", "Scale", "Mortar Size", "Mortar Smooth", "Bias"),
        *("Brick Width", "Row Height"),
    )
    inputs = [_place(reader, node, groups), *reader.values(node, names, groups)]
    inputs += [
        ("Offset", reader.number(node.offset)),
        ("Offset Every", reader.number(node.offset_frequency)),
        ("Squash", reader.number(node.squash)),
        ("Squash Every", reader.number(node.squash_frequency)),
    ]
    return reader.add("brick", inputs)


@reads("TEX_GRADIENT")
def _gradient(reader, node, groups):
    settings = (("type", node.gradient_type),)
    return reader.add("gradient", [_place(reader, node, groups)], settings)


@reads("TEX_GABOR")
def _gabor(reader, node, groups):
    flat = node.gabor_type == "2D"
    turned = "Orientation 2D" if flat else "Orientation 3D"
    names = ("Scale", "Frequency", "Anisotropy", turned)
    inputs = [_place(reader, node, groups), *reader.values(node, names, groups)]
    return reader.add("gabor", inputs, (("type", node.gabor_type),))


@reads("ShaderNodeRadialTiling")
def _radial_tiling(reader, node, groups):
    inputs = reader.values(node, ("Vector", "Sides", "Roundness"), groups)
    return reader.add("radial_tiling", inputs, (("normalize", "1" if node.normalize else ""),))
