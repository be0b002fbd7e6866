"""Nodes that compute numbers, vectors and colours.

Each operation and blend mode has a test of its own in finer numbers; these are one of each node.
"""

from .case import Case


def _points(bpy, node):
    mapping = node.mapping
    for i, curve in enumerate(mapping.curves):
        curve.points.new(0.3, 0.5 + 0.1 * i)
        curve.points[-1].location = (1.0, 0.8 - 0.05 * i)
    mapping.update()


def _ramp(bpy, node):
    node.color_ramp.elements[0].color = (0.9, 0.1, 0.2, 0.3)
    node.color_ramp.elements.new(0.4).color = (0.1, 0.8, 0.4, 0.6)


def _temperature(bpy, node):
    """Feed the input a number between 500 and 14500."""
    tree = node.id_data
    scaled = tree.nodes.new("ShaderNodeMath")
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = 14000.0, 500.0
    _link_along(tree, scaled.inputs[0])
    tree.links.new(scaled.outputs[0], node.inputs[0])


def _wavelength(bpy, node):
    tree = node.id_data
    scaled = tree.nodes.new("ShaderNodeMath")
    scaled.operation = "MULTIPLY_ADD"
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = 450.0, 360.0
    _link_along(tree, scaled.inputs[0])
    tree.links.new(scaled.outputs[0], node.inputs[0])


def _link_along(tree, socket):
    parts = tree.nodes.new("ShaderNodeSeparateXYZ")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["UV"], parts.inputs[0])
    tree.links.new(parts.outputs["X"], socket)


def _glow(bpy, node):
    tree = node.id_data
    glow = tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Color"].default_value = (0.2, 0.5, 0.7, 1.0)
    tree.links.new(glow.outputs[0], node.inputs[0])


_SCRIPT = "shader tint(float a = 0.7, output color C = 0) { C = color(a, 0.2, 0.4); }"


def _script(bpy, node):
    from addon.scene.images.color_spaces import bundled_module

    # Cycles asks it for the script's sockets.
    bundled_module("oslquery")
    import cycles.osl

    text = bpy.data.texts.new("tint.osl")
    text.write(_SCRIPT)
    node.mode, node.script = "INTERNAL", text
    cycles.osl.update_script_node(node, lambda *told: None)


CASES = [
    Case("Script", "C", {}, {}, _script, gain=0.5),
    *(Case("ShaderToRGB", name, {}, {}, _glow, gain=0.5) for name in ("Color", "Alpha")),
    *(
        Case("Math", "Value", {"Value": "x", "Value_001": "y", "Value_002": 0.3}, {"operation": o})
        for o in ("ADD", "MULTIPLY_ADD", "POWER", "SMOOTH_MIN", "SINE", "ARCTAN2")
    ),
    *(
        Case("VectorMath", "Vector", {"Vector": "signed", "Vector_001": "color"}, {"operation": o})
        for o in ("ADD", "CROSS_PRODUCT", "REFLECT", "PROJECT")
    ),
    Case(
        "VectorMath",
        "Value",
        {"Vector": "signed", "Vector_001": "color"},
        {"operation": "DISTANCE"},
    ),
    Case("Clamp", "Result", {"Value": "x", "Min": 0.2, "Max": 0.7}),
    *(
        Case(
            "MapRange",
            "Result",
            {"Value": "x", "From Max": 0.8, "To Max": 0.6},
            {"interpolation_type": i},
        )
        for i in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP")
    ),
    *(
        Case(
            "Mix",
            "Result_Color",
            {"Factor_Float": "y", "A_Color": "color", "B_Color": (0.9, 0.3, 0.2)},
            {"data_type": "RGBA", "blend_type": b},
        )
        for b in ("MIX", "OVERLAY", "SOFT_LIGHT", "HUE")
    ),
    Case("Mix", "Result_Float", {"Factor_Float": "y", "A_Float": "x", "B_Float": 0.3}),
    Case("Mix", "Result_Vector", {"Factor_Float": "y", "A_Vector": "uv"}, {"data_type": "VECTOR"}),
    Case(
        "MixRGB",
        "Color",
        {"Fac": "y", "Color1": "color", "Color2": (0.9, 0.3, 0.2)},
        {"blend_type": "SCREEN"},
    ),
    Case("HueSaturation", "Color", {"Color": "color", "Hue": 0.7, "Saturation": 1.4}),
    Case("Gamma", "Color", {"Color": "color", "Gamma": 1.8}),
    Case("BrightContrast", "Color", {"Color": "color", "Bright": 0.1, "Contrast": 0.4}),
    Case("Invert", "Color", {"Color": "color", "Fac": 0.8}),
    Case("RGBToBW", "Val", {"Color": "color"}),
    *(
        Case("SeparateColor", "Green", {"Color": "color"}, {"mode": m})
        for m in ("RGB", "HSV", "HSL")
    ),
    *(
        Case("CombineColor", "Color", {"Red": "x", "Green": "y", "Blue": 0.6}, {"mode": m})
        for m in ("RGB", "HSV", "HSL")
    ),
    Case("SeparateXYZ", "Y", {"Vector": "uv"}),
    Case("CombineXYZ", "Vector", {"X": "y", "Y": "x", "Z": 0.2}),
    Case("ValToRGB", "Color", {"Fac": "x"}, {}, _ramp),
    Case("ValToRGB", "Alpha", {"Fac": "x"}, {}, _ramp),
    Case("RGBCurve", "Color", {"Color": "color", "Fac": 0.8}, {}, _points),
    Case("VectorCurve", "Vector", {"Vector": "uv"}, {}, _points),
    Case("FloatCurve", "Value", {"Value": "x"}, {}, _points),
    Case("Blackbody", "Color", {}, {}, _temperature),
    Case("Blackbody", "Color", {"Temperature": 3200.0}),
    Case("Wavelength", "Color", {}, {}, _wavelength),
    Case("Wavelength", "Color", {"Wavelength": 560.0}),
    Case("RGB", "Color"),
    Case("Value", "Value"),
    *(
        Case(
            "Mapping",
            "Vector",
            {"Vector": "signed", "Rotation": (0.2, 0.4, 0.6), "Scale": (1.2, 0.7, 2.0)},
            {"vector_type": t},
        )
        for t in ("POINT", "TEXTURE", "VECTOR", "NORMAL")
    ),
]
