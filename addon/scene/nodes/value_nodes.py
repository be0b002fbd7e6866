"""From Blender's nodes that compute numbers, vectors and colours to those of a `SurfaceGraph`."""

from functools import cache

import numpy as np

from ...sampling.spectrum import color_matching
from ...snapshot.surface_graph import Constant, Link
from ..images import color_spaces
from .tree_reader import reader_registry

READERS, reads = reader_registry()

# As many as Cycles takes.
_TABLE_ROWS = 257


def _inputs(reader, node, groups, **identifiers):
    """Return the inputs of a node under the names that the graph has for them."""
    return [(name, reader.value(node, socket, groups)) for name, socket in identifiers.items()]


def _as(reader, node, kind, inputs, settings, outputs, table=()):
    """Add a node and link its outputs to Blender's: identifiers by the graph's name."""
    index = reader.add(kind, inputs, settings, table=table)
    return {socket: Link(index, name) for name, socket in outputs.items()}


def _flag(value):
    return "1" if value else ""


@reads("MATH")
def _math(reader, node, groups):
    inputs = _inputs(reader, node, groups, a="Value", b="Value_001", c="Value_002")
    settings = (("operation", node.operation), ("clamp", _flag(node.use_clamp)))
    return reader.add("math", inputs, settings)


@reads("VECT_MATH")
def _vector_math(reader, node, groups):
    sockets = {"a": "Vector", "b": "Vector_001", "c": "Vector_002", "scale": "Scale"}
    inputs = _inputs(reader, node, groups, **sockets)
    return reader.add("vector_math", inputs, (("operation", node.operation),))


@reads("CLAMP")
def _clamp(reader, node, groups):
    inputs = reader.values(node, ("Value", "Min", "Max"), groups)
    return reader.add("clamp", inputs, (("type", node.clamp_type),))


@reads("MAP_RANGE")
def _map_range(reader, node, groups):
    is_vector = node.data_type == "FLOAT_VECTOR"
    names = ("From Min", "From Max", "To Min", "To Max", "Steps")
    inputs = [("Value", reader.value(node, "Vector" if is_vector else "Value", groups))]
    for name in names:
        socket = name.replace(" ", "_") + "_FLOAT3" if is_vector else name
        inputs.append((name, reader.value(node, socket, groups)))
    # Smooth steps are clamped by themselves.
    clamps = node.clamp and node.interpolation_type in {"LINEAR", "STEPPED"}
    settings = (
        ("vector", _flag(is_vector)),
        ("interpolation", node.interpolation_type),
        ("clamp", _flag(clamps)),
    )
    return reader.add("map_range", inputs, settings)


@reads("MIX")
def _mix(reader, node, groups):
    if node.data_type == "RGBA":
        inputs = _inputs(reader, node, groups, factor="Factor_Float", a="A_Color", b="B_Color")
        settings = (
            ("blend", node.blend_type),
            ("clamp_factor", _flag(node.clamp_factor)),
            ("clamp_result", _flag(node.clamp_result)),
        )
        return _as(reader, node, "mix_color", inputs, settings, {"Color": "Result_Color"})
    kind = {"FLOAT": "Float", "VECTOR": "Vector"}.get(node.data_type)
    if kind is None:
        return None
    by_component = kind == "Vector" and node.factor_mode == "NON_UNIFORM"
    factor = "Factor_Vector" if by_component else "Factor_Float"
    inputs = _inputs(reader, node, groups, factor=factor, a=f"A_{kind}", b=f"B_{kind}")
    settings = (
        ("vector", _flag(kind == "Vector")),
        ("by_component", _flag(by_component)),
        ("clamp_factor", _flag(node.clamp_factor)),
    )
    return _as(reader, node, "mix_value", inputs, settings, {"Result": f"Result_{kind}"})


@reads("MIX_RGB")
def _mix_rgb(reader, node, groups):
    inputs = _inputs(reader, node, groups, factor="Fac", a="Color1", b="Color2")
    settings = (
        ("blend", node.blend_type),
        ("clamp_factor", "1"),
        ("clamp_result", _flag(node.use_clamp)),
    )
    return reader.add("mix_color", inputs, settings)


@reads("HUE_SAT")
def _hue_saturation(reader, node, groups):
    names = ("Color", "Hue", "Saturation", "Value", "Fac")
    return reader.add("hue_saturation", reader.values(node, names, groups))


@reads("GAMMA")
def _gamma(reader, node, groups):
    return reader.add("gamma", reader.values(node, ("Color", "Gamma"), groups))


@reads("BRIGHTCONTRAST")
def _contrast(reader, node, groups):
    return reader.add("contrast", reader.values(node, ("Color", "Bright", "Contrast"), groups))


@reads("INVERT")
def _invert(reader, node, groups):
    return reader.add("invert", reader.values(node, ("Color", "Fac"), groups))


@reads("RGBTOBW")
def _luminance(reader, node, groups):
    return reader.add("luminance", reader.values(node, ("Color",), groups))


@reads("COMBINE_COLOR")
def _combine_color(reader, node, groups):
    inputs = _inputs(reader, node, groups, a="Red", b="Green", c="Blue")
    settings = (("model", node.mode),)
    return _as(reader, node, "combine", inputs, settings, {"Result": "Color"})


@reads("COMBXYZ")
def _combine_vector(reader, node, groups):
    inputs = _inputs(reader, node, groups, a="X", b="Y", c="Z")
    return _as(reader, node, "combine", inputs, (("model", "XYZ"),), {"Result": "Vector"})


@reads("SEPARATE_COLOR")
def _separate_color(reader, node, groups):
    inputs = _inputs(reader, node, groups, Value="Color")
    settings = (("model", node.mode),)
    outputs = {"a": "Red", "b": "Green", "c": "Blue"}
    return _as(reader, node, "separate", inputs, settings, outputs)


@reads("SEPXYZ")
def _separate_vector(reader, node, groups):
    inputs = _inputs(reader, node, groups, Value="Vector")
    outputs = {"a": "X", "b": "Y", "c": "Z"}
    return _as(reader, node, "separate", inputs, (("model", "XYZ"),), outputs)


@reads("VALTORGB")
def _ramp(reader, node, groups):
    if not reader.has_room(_TABLE_ROWS):
        return None
    ramp = node.color_ramp
    table = tuple(tuple(ramp.evaluate(i / (_TABLE_ROWS - 1))) for i in range(_TABLE_ROWS))
    inputs = reader.values(node, ("Fac",), groups)
    settings = (("steps", _flag(ramp.interpolation == "CONSTANT")),)
    return reader.add("ramp", inputs, settings, table=table)


@reads("CURVE_RGB", "CURVE_VEC", "CURVE_FLOAT")
def _curves(reader, node, groups):
    if not reader.has_room(_TABLE_ROWS):
        return None
    channels, value, factor, output = {
        "CURVE_RGB": ("RGB", "Color", "Fac", "Color"),
        "CURVE_VEC": ("XYZ", "Vector", "Fac", "Vector"),
        "CURVE_FLOAT": ("1", "Value", "Factor", "Value"),
    }[node.type]
    mapping = node.mapping
    mapping.initialize()
    curves = list(mapping.curves)
    ends = [(curve.points[0].location[0], curve.points[-1].location[0]) for curve in curves]
    start, end = min(first for first, _ in ends), max(last for _, last in ends)
    table = []
    for i in range(_TABLE_ROWS):
        place = start + (end - start) * i / (_TABLE_ROWS - 1)
        if channels == "RGB":
            # The curve of all channels comes first.
            place = mapping.evaluate(curves[3], place)
        row = [mapping.evaluate(curve, place) for curve in curves[:3]]
        table.append((*row, *[0.0] * (4 - len(row))))
    inputs = _inputs(reader, node, groups, Value=value, Fac=factor)
    inputs += [("Start", Constant((start,))), ("Width", Constant((max(end - start, 1e-6),)))]
    settings = (
        ("channels", channels),
        ("extrapolated", _flag(mapping.extend == "EXTRAPOLATED")),
    )
    return _as(reader, node, "curves", inputs, settings, {"Result": output}, tuple(table))


# Between these temperatures, in K, Cycles' black bodies change.
_COLDEST, _HOTTEST = 800.0, 12000.0
# What Cycles divides the colours of wavelengths by.
_WAVELENGTH_SCALE = 2.52


# Memo of its arguments alone.
@cache
def _black_body_table(space, count=129):
    """Return colours of black bodies of luminance 1, evenly spaced in 1 / temperature."""
    wavelengths = np.arange(360.0, 831.0)
    metres = wavelengths * 1e-9
    temperature = 1.0 / np.linspace(1.0 / _HOTTEST, 1.0 / _COLDEST, count)[:, None]
    # Planck's law; hc / k in m K.
    light = 1.0 / (metres**5 * np.expm1(1.4387769e-2 / (metres * temperature)))
    xyz = light @ color_matching(wavelengths)
    return _rows(xyz / xyz[:, 1:2], space)


# Memo of its arguments alone.
@cache
def _wavelength_table(space):
    """Return colours of wavelengths from 380 to 780 nm, 5 nm apart."""
    return _rows(color_matching(np.arange(380.0, 785.0, 5.0)) / _WAVELENGTH_SCALE, space)


def _rows(xyz, space):
    pixels = color_spaces.from_xyz(xyz[None], space)
    return tuple(tuple(map(float, row)) for row in pixels[0])


@reads("BLACKBODY")
def _black_body(reader, node, groups):
    table = _black_body_table(color_spaces.working_space())
    if not reader.has_room(len(table)):
        return None
    ends = [("Coldest", Constant((_COLDEST,))), ("Hottest", Constant((_HOTTEST,)))]
    inputs = [*reader.values(node, ("Temperature",), groups), *ends]
    return reader.add("black_body", inputs, table=table)


@reads("WAVELENGTH")
def _wavelength(reader, node, groups):
    table = _wavelength_table(color_spaces.working_space())
    if not reader.has_room(len(table)):
        return None
    return reader.add("wavelength", reader.values(node, ("Wavelength",), groups), table=table)


@reads("LIGHT_FALLOFF")
def _light_falloff(reader, node, groups):
    inputs = reader.values(node, ("Strength", "Smooth"), groups)
    inputs.append(("Length", Link(reader.add("camera_data"), "View Distance")))
    return reader.add("light_falloff", inputs)
