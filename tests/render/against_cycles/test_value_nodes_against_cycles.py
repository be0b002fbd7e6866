"""Nodes between a texture and a shader compute Blender's own numbers."""

import numpy as np
import pytest

from addon.passes.nodes.value_nodes import MATH, VECTOR_MATH, VECTOR_NUMBERS
from tests.pictures import save_side_by_side
from tests.surface_scenes import both, card_scene, image

BLENDS = (
    *("MIX", "DARKEN", "MULTIPLY", "BURN", "LIGHTEN", "SCREEN", "DODGE", "ADD", "OVERLAY"),
    *("SOFT_LIGHT", "LINEAR_LIGHT", "DIFFERENCE", "EXCLUSION", "SUBTRACT", "DIVIDE"),
    *("HUE", "SATURATION", "COLOR", "VALUE"),
)
TEXELS = 16
# Single precision; Cycles' own sine, logarithm and powers are good to about 1e-4 of the value.
RELATIVE = 5e-4
ABSOLUTE = 2e-5


@pytest.fixture
def bpy(aplanat_bpy):
    return aplanat_bpy


def texture(bpy, tree, seed, low=0.0, high=1.0):
    """A texture of a float image with one texel a pixel."""
    pixels = np.random.default_rng(seed).uniform(low, high, (TEXELS, TEXELS, 4))
    pixels = pixels.astype(np.float32)
    pixels[..., 3] = 1.0
    # Numbers that operations treat apart.
    pixels[0, :6, :3] = np.array([0.0, 1.0, -1.0, 0.5, 2.0, 0.25])[:, None]
    pixels[1, :3, :3] = np.diag([0.8, 0.4, 0.6])
    made = image(bpy, f"values {seed}", pixels, True, "Linear Rec.709")
    made.colorspace_settings.name = "Non-Color"
    return tree.node("TexImage", image=made, interpolation="Closest").outputs["Color"]


def assert_equal(scene, tmp_path, exempt=0.0):
    ours, cycles = both(scene, cycles_samples=1)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    assert np.isfinite(ours).all()
    finite = np.isfinite(cycles).all(axis=2)
    off = np.abs(ours - cycles) > ABSOLUTE + RELATIVE * np.abs(cycles)
    off = off.any(axis=2) & finite
    assert off.mean() <= exempt, f"{tmp_path}\n{ours[off][:4]}\n{cycles[off][:4]}"


def number(bpy, tree, seed, low, high):
    """One channel of a texture, exactly: a colour's luminance is rounded."""
    parts = tree.node("SeparateXYZ", {"Vector": texture(bpy, tree, seed, low, high)})
    return parts.outputs["X"]


def output(node, identifier):
    return next(socket for socket in node.outputs if socket.identifier == identifier)


def show(tree, socket):
    tree.emission(socket)


# Where a step of the function lies at the texel's own value, rounding decides.
_STEPS = {"SNAP", "WRAP", "MODULO", "FLOORED_MODULO", "PINGPONG"}


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("operation", MATH)
def test_each_operation_of_numbers_is_that_of_cycles(bpy, tmp_path, operation, clamp):
    if clamp and operation not in {"ADD", "TANGENT"}:
        pytest.skip("clamping is the same for all")
    scene, _, tree = card_scene(bpy, TEXELS)
    inputs = {
        "Value": number(bpy, tree, 1, -2.0, 2.0),
        "Value_001": number(bpy, tree, 2, -2.0, 2.0),
        "Value_002": number(bpy, tree, 3, -1.0, 1.0),
    }
    node = tree.node("Math", inputs, operation=operation, use_clamp=clamp)
    show(tree, node.outputs[0])
    assert_equal(scene, tmp_path, 0.02 if operation in _STEPS else 0.0)


@pytest.mark.parametrize("operation", [*VECTOR_MATH, *VECTOR_NUMBERS])
def test_each_operation_of_vectors_is_that_of_cycles(bpy, tmp_path, operation):
    scene, _, tree = card_scene(bpy, TEXELS)
    inputs = {
        "Vector": texture(bpy, tree, 1, -2.0, 2.0),
        "Vector_001": texture(bpy, tree, 2, -2.0, 2.0),
        "Vector_002": texture(bpy, tree, 3, -1.0, 1.0),
        "Scale": 0.7,
    }
    node = tree.node("VectorMath", inputs, operation=operation)
    show(tree, node.outputs["Value" if operation in VECTOR_NUMBERS else "Vector"])
    assert_equal(scene, tmp_path, 0.02 if operation in _STEPS else 0.0)


@pytest.mark.parametrize("blend", BLENDS)
def test_each_blend_mode_is_that_of_cycles(bpy, tmp_path, blend):
    scene, _, tree = card_scene(bpy, TEXELS)
    inputs = {
        "Factor_Float": texture(bpy, tree, 4, 0.0, 1.3),
        "A_Color": texture(bpy, tree, 5, 0.0, 1.2),
        "B_Color": texture(bpy, tree, 6, 0.0, 1.2),
    }
    settings = {"data_type": "RGBA", "blend_type": blend}
    node = tree.node("Mix", inputs, **settings)
    show(tree, output(node, "Result_Color"))
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize("clamp_factor", [False, True])
@pytest.mark.parametrize("clamp_result", [False, True])
def test_mixed_colors_are_clamped_as_told(bpy, tmp_path, clamp_factor, clamp_result):
    scene, _, tree = card_scene(bpy, TEXELS)
    inputs = {
        "Factor_Float": texture(bpy, tree, 4, -0.5, 1.5),
        "A_Color": texture(bpy, tree, 5, -0.5, 1.5),
        "B_Color": (0.9, 0.2, 0.4),
    }
    clamps = {"clamp_factor": clamp_factor, "clamp_result": clamp_result}
    node = tree.node("Mix", inputs, data_type="RGBA", **clamps)
    show(tree, output(node, "Result_Color"))
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize("kind", ["Float", "Vector", "each component"])
def test_numbers_and_vectors_are_mixed(bpy, tmp_path, kind):
    scene, _, tree = card_scene(bpy, TEXELS)
    by_component = kind == "each component"
    name = "Vector" if by_component else kind
    factor = "Factor_Vector" if by_component else "Factor_Float"
    inputs = {
        factor: texture(bpy, tree, 4, -0.5, 1.5),
        f"A_{name}": texture(bpy, tree, 5, -1.0, 1.0),
        f"B_{name}": texture(bpy, tree, 6, -1.0, 1.0),
    }
    mode = "NON_UNIFORM" if by_component else "UNIFORM"
    node = tree.node("Mix", inputs, data_type=name.upper(), factor_mode=mode)
    show(tree, output(node, f"Result_{name}"))
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize("kind", ["MINMAX", "RANGE"])
def test_both_kinds_of_clamp_are_those_of_cycles(bpy, tmp_path, kind):
    scene, _, tree = card_scene(bpy, TEXELS)
    inputs = {"Value": texture(bpy, tree, 7, -1.0, 2.0), "Min": 0.8, "Max": 0.3}
    show(tree, tree.node("Clamp", inputs, clamp_type=kind).outputs[0])
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("kind", ["FLOAT", "FLOAT_VECTOR"])
@pytest.mark.parametrize("interpolation", ["LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"])
def test_map_range_is_that_of_cycles(bpy, tmp_path, interpolation, kind, clamp):
    scene, _, tree = card_scene(bpy, TEXELS)
    value = texture(bpy, tree, 8, -1.0, 2.0)
    if kind == "FLOAT":
        inputs = {"Value": value, "From Min": 0.7, "From Max": 0.13, "To Min": -0.4, "To Max": 1.7}
        inputs["Steps"] = 3.0
    else:
        inputs = {
            "Vector": value,
            "From_Min_FLOAT3": (0.1, 0.7, 0.2),
            "From_Max_FLOAT3": (0.7, 0.1, 0.2),
            "To_Min_FLOAT3": (0.0, 1.0, -1.0),
            "To_Max_FLOAT3": (1.5, 0.3, 1.0),
            "Steps_FLOAT3": (3.0, 4.0, 0.0),
        }
    settings = {"data_type": kind, "interpolation_type": interpolation, "clamp": clamp}
    node = tree.node("MapRange", inputs, **settings)
    show(tree, node.outputs["Result" if kind == "FLOAT" else "Vector"])
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize(
    "kind, inputs",
    [
        ("HueSaturation", {"Hue": 0.8, "Saturation": 1.7, "Value": 0.6, "Fac": 0.8}),
        ("HueSaturation", {"Hue": 0.5, "Saturation": 0.2, "Value": 2.0, "Fac": 1.0}),
        ("Gamma", {"Gamma": 2.2}),
        ("Gamma", {"Gamma": 0.0}),
        ("BrightContrast", {"Bright": 0.1, "Contrast": 0.5}),
        ("BrightContrast", {"Bright": -0.2, "Contrast": -0.3}),
        ("Invert", {"Fac": 0.7}),
        ("RGBToBW", {}),
    ],
)
def test_each_node_of_one_color_is_that_of_cycles(bpy, tmp_path, kind, inputs):
    scene, _, tree = card_scene(bpy, TEXELS)
    inputs = {**inputs, "Color": texture(bpy, tree, 9, -0.2, 1.4)}
    show(tree, tree.node(kind, inputs).outputs[0])
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize("model", ["RGB", "HSV", "HSL"])
def test_colors_are_parted_and_put_together(bpy, tmp_path, model):
    scene, _, tree = card_scene(bpy, TEXELS)
    parts = tree.node("SeparateColor", {"Color": texture(bpy, tree, 10, 0.0, 1.2)}, mode=model)
    show(tree, parts.outputs["Green"])
    assert_equal(scene, tmp_path)
    made = tree.node(
        "CombineColor",
        {"Red": parts.outputs["Red"], "Green": 0.6, "Blue": parts.outputs["Blue"]},
        mode=model,
    )
    show(tree, made.outputs[0])
    assert_equal(scene, tmp_path)


def test_vectors_are_parted_and_put_together(bpy, tmp_path):
    scene, _, tree = card_scene(bpy, TEXELS)
    parts = tree.node("SeparateXYZ", {"Vector": texture(bpy, tree, 10, -1.0, 1.0)})
    inputs = {"X": parts.outputs["Z"], "Y": parts.outputs["X"], "Z": 0.3}
    show(tree, tree.node("CombineXYZ", inputs).outputs[0])
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize(
    "mode, interpolation",
    [("RGB", "LINEAR"), ("RGB", "CONSTANT"), ("RGB", "EASE"), ("RGB", "B_SPLINE"), ("HSV", "NEAR")],
)
@pytest.mark.parametrize("output", ["Color", "Alpha"])
def test_color_ramps_are_those_of_cycles(bpy, tmp_path, mode, interpolation, output):
    scene, _, tree = card_scene(bpy, TEXELS)
    node = tree.node("ValToRGB", {"Fac": texture(bpy, tree, 11, -0.2, 1.2)})
    ramp = node.color_ramp
    ramp.color_mode = mode
    setattr(ramp, "hue_interpolation" if mode == "HSV" else "interpolation", interpolation)
    ramp.elements[0].color, ramp.elements[1].color = (0.9, 0.1, 0.2, 0.3), (0.1, 0.3, 0.8, 1.0)
    ramp.elements.new(0.37).color = (2.0, 1.0, 0.0, 0.6)
    show(tree, node.outputs[output])
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize("extend", ["HORIZONTAL", "EXTRAPOLATED"])
@pytest.mark.parametrize("kind", ["RGBCurve", "VectorCurve", "FloatCurve"])
def test_curves_are_those_of_cycles(bpy, tmp_path, kind, extend):
    scene, _, tree = card_scene(bpy, TEXELS)
    value = texture(bpy, tree, 12, -0.4, 1.4)
    factor = "Factor" if kind == "FloatCurve" else "Fac"
    name = {"RGBCurve": "Color", "VectorCurve": "Vector", "FloatCurve": "Value"}[kind]
    node = tree.node(kind, {factor: 0.8, name: value})
    mapping = node.mapping
    mapping.extend = extend
    for i, curve in enumerate(mapping.curves):
        curve.points.new(0.3, 0.5 + 0.1 * i)
        curve.points[-1].location = (1.0, 0.8 - 0.05 * i)
    mapping.update()
    show(tree, node.outputs[0])
    assert_equal(scene, tmp_path)


def test_a_chain_behind_a_mix_keeps_its_images(bpy, tmp_path):
    """The usual chain of a texture: hue, contrast and ramp, mixed with another, in a shader."""
    scene, _, tree = card_scene(bpy, TEXELS)
    first = tree.node("HueSaturation", {"Hue": 0.55, "Color": texture(bpy, tree, 13)})
    grey = tree.node("RGBToBW", {"Color": texture(bpy, tree, 14)})
    ramp = tree.node("ValToRGB", {"Fac": grey.outputs[0]})
    mixed = tree.node(
        "Mix",
        {
            "Factor_Float": grey.outputs[0],
            "A_Color": first.outputs[0],
            "B_Color": ramp.outputs["Color"],
        },
        data_type="RGBA",
        blend_type="OVERLAY",
    )
    power = tree.node("Math", {"Value": grey.outputs[0], "Value_001": 0.5}, operation="POWER")
    tree.emission(output(mixed, "Result_Color"), power.outputs[0])
    assert_equal(scene, tmp_path)


def test_what_has_no_value_stays_out_of_the_picture(bpy, tmp_path):
    """A power that overflows, times zero."""
    scene, _, tree = card_scene(bpy, TEXELS)
    huge = tree.node(
        "Math", {"Value": texture(bpy, tree, 15, 50.0, 90.0), "Value_001": 80.0}, operation="POWER"
    )
    none = tree.node("Math", {"Value": huge.outputs[0], "Value_001": 0.0}, operation="MULTIPLY")
    show(tree, none.outputs[0])
    assert_equal(scene, tmp_path)


def test_a_number_that_feeds_a_vector_counts_for_all_three(bpy, tmp_path):
    scene, _, tree = card_scene(bpy, TEXELS)
    angle = tree.node("Value")
    angle.outputs[0].default_value = 0.7
    inputs = {"Vector": texture(bpy, tree, 1), "Rotation": angle.outputs[0]}
    turned = tree.node("Mapping", inputs)
    tree.surface(tree.node("Emission", {"Color": turned.outputs[0]}).outputs[0])
    assert_equal(scene, tmp_path)


@pytest.mark.parametrize("color", [(0.0, 0.6, 0.2), (1.0, 0.3, 0.0)])
def test_a_colour_that_feeds_a_mix_counts_by_its_luminance(bpy, tmp_path, color):
    scene, _, tree = card_scene(bpy, TEXELS)
    share = tree.node("RGB")
    share.outputs[0].default_value = (*color, 1.0)
    pair = [tree.node("Emission", {"Color": c}).outputs[0] for c in ((1, 0, 0), (0, 1, 0))]
    inputs = {"Fac": share.outputs[0], "Shader": pair[0], "Shader_001": pair[1]}
    tree.surface(tree.node("MixShader", inputs).outputs[0])
    assert_equal(scene, tmp_path)
