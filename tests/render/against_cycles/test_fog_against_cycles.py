"""Volumes in boxes look about as in Cycles: what passes, and what thin fog scatters."""

import numpy as np
import pytest

from tests.pictures import render_aplanat, render_cycles

GREY = (0.5, 0.5, 0.5)


def fog_scene(bpy, kind, inputs, inside=False, sun=False):
    """A box of fog before a grey world or under a sun."""
    from mathutils import Vector

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 24
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (0.1, 0.0, 0.1) if inside else (2.5, -4.0, 2.0)
    towards = (0.0, -1.0, 0.0) if inside else camera.location
    camera.rotation_euler = Vector(towards).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    box = bpy.context.object
    box.scale = (1.0, 0.8, 0.6)
    material = bpy.data.materials.new("fog")
    tree = material.node_tree
    tree.nodes.clear()
    output, node = (tree.nodes.new(f"ShaderNode{k}") for k in ("OutputMaterial", kind))
    for name, value in inputs.items():
        is_color = node.inputs[name].type == "RGBA"
        node.inputs[name].default_value = (*value, 1.0) if is_color else value
    tree.links.new(node.outputs[0], output.inputs["Volume"])
    box.data.materials.append(material)
    world = scene.world = bpy.data.worlds.new("world")
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*((0.0,) * 3 if sun else (0.6, 0.5, 0.4)), 1.0)
    if sun:
        lamp = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
        lamp.data.energy = 3.0
        lamp.rotation_euler = (0.6, 0.3, 0.0)
        scene.collection.objects.link(lamp)
    return scene


@pytest.mark.parametrize("inside", [False, True])
def test_light_that_passes_fog_is_that_of_cycles(aplanat_bpy, inside):
    fog = {"Color": GREY, "Density": 1.3}
    scene = fog_scene(aplanat_bpy, "VolumeAbsorption", fog, inside)
    ours, cycles = render_aplanat(scene, 64), render_cycles(scene, 16)
    assert cycles[..., 0].min() < 0.4
    # Each of 64 samples sees through or not: 0.5 / 8 of what is behind, times 0.6.
    difference = np.abs(ours - cycles)[..., :3]
    assert difference.mean() < 0.03
    assert np.abs((ours - cycles)[..., :3].mean(axis=(0, 1))).max() < 0.006


@pytest.mark.parametrize(
    "kind, inputs",
    [
        ("VolumeScatter", {"Color": (0.9, 0.5, 0.3), "Density": 0.1, "Anisotropy": 0.4}),
        ("VolumePrincipled", {"Color": GREY, "Density": 0.1}),
        (
            "VolumeCoefficients",
            {
                "Scatter Coefficients": (0.05, 0.1, 0.15),
                "Absorption Coefficients": (0.1, 0.05, 0.05),
                "Emission Coefficients": (0.1, 0.05, 0.0),
            },
        ),
    ],
)
def test_thin_fog_scatters_and_glows_as_in_cycles(aplanat_bpy, kind, inputs):
    scene = fog_scene(aplanat_bpy, kind, inputs, sun=True)
    ours = render_aplanat(scene, 16)[..., :3].mean(axis=(0, 1))
    cycles = render_cycles(scene, 128)[..., :3].mean(axis=(0, 1))
    # The sun's light that does not reach the middle of the fog: 0.1 / m, on half of 1.6 m.
    assert ours == pytest.approx(cycles, rel=0.13)


def test_mixed_volumes_are_told_and_not_drawn(aplanat_bpy):
    scene = fog_scene(aplanat_bpy, "VolumeScatter", {})
    tree = aplanat_bpy.data.materials["fog"].node_tree
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    both = tree.nodes.new("ShaderNodeAddShader")
    for kind, socket in zip(("VolumeAbsorption", "VolumeScatter"), both.inputs, strict=True):
        tree.links.new(tree.nodes.new(f"ShaderNode{kind}").outputs[0], socket)
    tree.links.new(both.outputs[0], output.inputs["Volume"])
    from addon.scene.shading.materials import MaterialReader

    reader = MaterialReader()
    material = aplanat_bpy.data.materials["fog"]
    reader.read(material.evaluated_get(aplanat_bpy.context.evaluated_depsgraph_get()))
    assert reader.report == ["material 'fog': volume is not drawn"]
    ours = render_aplanat(scene, 1)[..., :3]
    assert np.allclose(ours, (0.6, 0.5, 0.4), atol=1e-3)
