"""The same frames on OpenGL and on Vulkan: every shader that they need compiles and agrees."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests import surface_scenes
from tests.pictures import ssim

REPO = Path(__file__).resolve().parents[2]
SIZE, SAMPLES = "112x63", 4


def combined(path):
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            channels = part.channels
            for name in channels:
                if name.endswith("Combined.R") or name == "R":
                    stem = name[:-1]
                    return np.stack([np.asarray(channels[stem + c].pixels) for c in "RGBA"], -1)
    raise AssertionError(f"no Combined pass in {path}")


def build(script, *arguments):
    done = subprocess.run(
        [sys.executable, script, *map(str, arguments)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="session")
def demo_blend(tmp_path_factory):
    path = tmp_path_factory.mktemp("demo") / "demo.blend"
    build(REPO / "scripts/demo_scene.py", "-o", path)
    return path


@pytest.fixture(scope="session")
def toys_blend(shared, tmp_path_factory):
    path = tmp_path_factory.mktemp("toys") / "toys.blend"
    script = shared / "scenes/build_scenes.py"
    build(script, "--scene", "toys", "--look", "flat", "--out", path)
    return path


@pytest.fixture(scope="session")
def toys_lit_blend(shared, tmp_path_factory):
    path = tmp_path_factory.mktemp("toys_lit") / "toys_lit.blend"
    script = shared / "scenes/build_scenes.py"
    build(script, "--scene", "toys", "--look", "lit", "--out", path)
    return path


@pytest.fixture(scope="session")
def surfaces_blend(aplanat_bpy, tmp_path_factory):
    """Every kind of closure, light and value node that there is a shader text for."""
    bpy = aplanat_bpy
    glossy = {"Color": (0.9, 0.7, 0.5), "Roughness": 0.3}
    half = {"Base Color": (0.2, 0.5, 0.9), "Alpha": 0.5}
    kinds = [("BsdfDiffuse", {}), ("BsdfGlossy", glossy), ("BsdfPrincipled", half)]
    scene = surface_scenes.sphere_scene(bpy, [*kinds, *[("Emission", {})] * 3])
    for kind in ("SUN", "POINT", "SPOT", "AREA"):
        surface_scenes.add_light(bpy, kind, (3.0, -5.0, 4.0), energy=50.0)
    balls = [obj for obj in scene.objects if obj.type == "MESH"][-3:]
    trees = [surface_scenes.Tree(ball.active_material.node_tree) for ball in balls]
    for tree in trees:
        tree.output = next(n for n in tree.tree.nodes if n.type == "OUTPUT_MATERIAL")
    through, light = (trees[0].node(kind).outputs[0] for kind in ("BsdfTransparent", "Emission"))
    parts = {"Shader": through, "Shader_001": light}
    trees[0].surface(trees[0].node("AddShader", parts).outputs[0])
    parts = {"Shader": trees[1].node("Holdout").outputs[0]}
    parts["Shader_001"] = trees[1].node("Emission", {"Color": (0.2, 0.8, 0.4)}).outputs[0]
    trees[1].surface(trees[1].node("MixShader", parts).outputs[0])
    uv = trees[2].node("TexCoord").outputs["UV"]
    inputs = {"Vector": uv, "Rotation": (0.1, 0.2, 0.3), "Scale": (2.0, 3.0, 1.0)}
    vector = trees[2].node("Mapping", inputs, vector_type="NORMAL").outputs[0]
    picture = surface_scenes.image(bpy, "picture", surface_scenes.random_pixels(4, alpha=True))
    texture = trees[2].node("TexImage", {"Vector": vector}, image=picture)
    trees[2].emission(texture.outputs["Color"], texture.outputs["Alpha"])
    path = tmp_path_factory.mktemp("surfaces") / "surfaces.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


@pytest.fixture(scope="session")
def nodes_blend(aplanat_bpy, tmp_path_factory):
    """Every operation and blend mode in chains, and a world of nodes."""
    from addon.passes.nodes.value_nodes import MATH, VECTOR_MATH, VECTOR_NUMBERS

    bpy = aplanat_bpy
    scene = surface_scenes.sphere_scene(bpy, [("Emission", {})] * 4)
    balls = [obj for obj in scene.objects if obj.type == "MESH"]
    trees = [surface_scenes.Tree(ball.active_material.node_tree) for ball in balls]
    for tree in trees:
        tree.output = next(n for n in tree.tree.nodes if n.type == "OUTPUT_MATERIAL")
    picture = surface_scenes.image(bpy, "picture", surface_scenes.random_pixels(4))

    def texture(tree):
        uv = tree.node("TexCoord").outputs["UV"]
        return tree.node("TexImage", {"Vector": uv}, image=picture).outputs["Color"]

    total = texture(trees[0])
    for operation in MATH:
        inputs = {"Value": texture(trees[0]), "Value_001": 0.7, "Value_002": 0.3}
        value = trees[0].node("Math", inputs, operation=operation, use_clamp=True).outputs[0]
        total = trees[0].node("Math", {"Value": total, "Value_001": value}).outputs[0]
    trees[0].emission((0.03, 0.02, 0.01), total)
    total = texture(trees[1])
    for operation in (*VECTOR_MATH, *VECTOR_NUMBERS):
        inputs = {"Vector": texture(trees[1]), "Vector_001": (0.4, 0.3, 0.9)}
        node = trees[1].node("VectorMath", inputs, operation=operation)
        value = node.outputs["Value" if operation in VECTOR_NUMBERS else "Vector"]
        total = trees[1].node("VectorMath", {"Vector": total, "Vector_001": value}).outputs[0]
    trees[1].emission(total, 0.03)
    color = texture(trees[2])
    mix = trees[2].node("Mix", data_type="RGBA")
    for blend in [item.identifier for item in mix.bl_rna.properties["blend_type"].enum_items]:
        inputs = {"Factor_Float": 0.3, "A_Color": color, "B_Color": texture(trees[2])}
        mix = trees[2].node("Mix", inputs, data_type="RGBA", blend_type=blend)
        color = next(s for s in mix.outputs if s.identifier == "Result_Color")
    trees[2].emission(color)
    color = texture(trees[3])
    for kind in ("HueSaturation", "Gamma", "BrightContrast", "Invert", "RGBCurve"):
        color = trees[3].node(kind, {"Color": color}).outputs[0]
    parts = trees[3].node("SeparateColor", {"Color": color}, mode="HSL")
    inputs = {"Red": parts.outputs[0], "Green": parts.outputs[1], "Blue": parts.outputs[2]}
    joined = trees[3].node("CombineColor", inputs, mode="HSV").outputs[0]
    ramp = trees[3].node("ValToRGB", {"Fac": trees[3].node("Clamp", {"Value": joined}).outputs[0]})
    mapped = trees[3].node("MapRange", {"Value": joined}, interpolation_type="SMOOTHERSTEP")
    trees[3].emission(ramp.outputs[0], mapped.outputs[0])
    world = surface_scenes.world_image(bpy, None).node_tree
    sky = surface_scenes.Tree(world, "ShaderNodeOutputWorld")
    found = sky.node("TexEnvironment", image=picture)
    turned = sky.node("HueSaturation", {"Hue": 0.7, "Color": found.outputs[0]})
    background = next(n for n in world.nodes if n.type == "BACKGROUND")
    world.links.new(turned.outputs[0], background.inputs["Color"])
    path = tmp_path_factory.mktemp("nodes") / "nodes.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


@pytest.fixture(scope="session")
def cards_blend(aplanat_bpy, tmp_path_factory):
    """Cards that glow with the outputs of nodes, a card for each output."""
    from benchmarks.nodes import image_cases, input_cases, pattern_cases, sheet

    modules = (input_cases, image_cases, pattern_cases)
    cases = {(c.node, c.output): c for module in modules for c in module.CASES}
    sheet.build_sheet(aplanat_bpy, list(cases.values()))
    path = tmp_path_factory.mktemp("cards") / "cards.blend"
    aplanat_bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


@pytest.fixture(scope="session")
def backends(blender, tmp_path_factory):
    """Return the names of the backends, each of which Blender was seen to use when asked."""
    folder = tmp_path_factory.mktemp("backends")
    for backend in ("opengl", "vulkan"):
        used = folder / backend
        probe = f"import gpu; open({str(used)!r}, 'w').write(gpu.platform.backend_type_get())"
        blender.run("--gpu-backend", backend, "--python-expr", f"import gpu; gpu.init(); {probe}")
        assert used.read_text().lower() == backend
    return ("opengl", "vulkan")


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["demo", "toys", "toys_lit", "surfaces", "nodes", "cards"])
def test_vulkan_agrees_with_opengl(scene, blender, backends, request, tmp_path):
    blend = request.getfixturevalue(f"{scene}_blend")
    pictures = {}
    for backend in backends:
        out = tmp_path / f"{backend}.exr"
        done = blender.run(
            *("--gpu-backend", backend, "--command", "aplanat", "render", blend, "-o", out),
            *("--resolution", SIZE, "--samples", SAMPLES),
        )
        pictures[backend] = combined(out)
        assert pictures[backend].max() > 0.1, done.stdout + done.stderr
    # The arithmetic is the same: only rasterisation and rounding may differ.
    assert ssim(pictures["vulkan"], pictures["opengl"]) >= 0.999
