"""Nodes between a world's images and its Background compute Cycles' numbers."""

import numpy as np
import pytest

from tests.pictures import render_aplanat, render_cycles
from tests.surface_scenes import TINY_FILTER, Tree, card_scene, image, world_image


@pytest.fixture
def scene(aplanat_bpy):
    """A wide view of the world, with a small matt card in its middle."""
    scene, card, tree = card_scene(aplanat_bpy, 24)
    tree.surface(tree.node("BsdfDiffuse", {"Color": (0.8, 0.8, 0.8)}).outputs[0])
    card.location.z = -3.0
    card.scale = (0.4, 0.4, 1.0)
    scene.camera.data.type = "PERSP"
    scene.camera.data.lens = 20.0
    scene.camera.rotation_euler.x = 0.1
    return scene


def sky(bpy, seed, byte=False):
    """A smooth image: a texel more or less makes no difference that counts."""
    y, x = np.mgrid[0:64, 0:128] / np.array([64.0, 128.0])[:, None, None]
    waves = [np.sin(2 * np.pi * (x * k + seed / 7)) * np.sin(np.pi * y) for k in (1, 2, 3)]
    pixels = np.ones((64, 128, 4), np.float32)
    pixels[..., :3] = 0.5 + 0.4 * np.stack(waves, axis=-1)
    space = "sRGB" if byte else "Linear Rec.709"
    return image(bpy, f"sky {seed}", pixels, not byte, space)


def background(bpy):
    world = world_image(bpy, None)
    node = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    return Tree(world.node_tree, "ShaderNodeOutputWorld"), node


def turned(tree, angle):
    place = tree.node("TexCoord").outputs["Generated"]
    mapping = tree.node("Mapping", {"Vector": place, "Rotation": (0.2, 0.0, angle)})
    return mapping.outputs[0]


def assert_like_cycles(scene):
    ours = render_aplanat(scene, 1)
    cycles = render_cycles(scene, 64, "BLACKMAN_HARRIS", TINY_FILTER)
    difference = np.abs(ours - cycles)[..., :3]
    # Between texels of the computed image colours are interpolated; hues have edges of their own.
    seen = np.ones(difference.shape[:2], bool)
    seen[6:18, 6:18] = False
    assert difference[seen].max() < 0.02
    assert difference[seen].mean() < 0.002
    # The card: prefiltered light, and Cycles' noise.
    card = (ours[11:13, 11:13] - cycles[11:13, 11:13])[..., :3]
    assert np.abs(card.mean(axis=(0, 1))).max() < 0.04


def test_hue_and_contrast_of_a_turned_image(aplanat_bpy, scene):
    tree, node = background(aplanat_bpy)
    found = tree.node("TexEnvironment", {"Vector": turned(tree, 0.7)}, image=sky(aplanat_bpy, 1))
    hue = tree.node("HueSaturation", {"Hue": 0.7, "Value": 1.4, "Color": found.outputs[0]})
    sharper = tree.node("BrightContrast", {"Color": hue.outputs[0], "Contrast": 0.3})
    tree.tree.links.new(sharper.outputs[0], node.inputs["Color"])
    node.inputs["Strength"].default_value = 1.5
    assert_like_cycles(scene)


def test_two_images_turned_differently_are_mixed(aplanat_bpy, scene):
    tree, node = background(aplanat_bpy)
    first = tree.node("TexEnvironment", {"Vector": turned(tree, 0.4)}, image=sky(aplanat_bpy, 1))
    second = tree.node("TexEnvironment", image=sky(aplanat_bpy, 3, byte=True))
    mix = tree.node("Mix", data_type="RGBA", blend_type="MULTIPLY")
    sockets = {socket.identifier: socket for socket in (*mix.inputs, *mix.outputs)}
    sockets["Factor_Float"].default_value = 0.6
    tree.tree.links.new(first.outputs[0], sockets["A_Color"])
    tree.tree.links.new(second.outputs[0], sockets["B_Color"])
    tree.tree.links.new(sockets["Result_Color"], node.inputs["Color"])
    assert_like_cycles(scene)


def test_a_changed_node_is_a_changed_world(aplanat_bpy):
    from addon.scene.images.images import ImageReader
    from addon.scene.shading.world import read_world

    card_scene(aplanat_bpy, 4)
    tree, node = background(aplanat_bpy)
    found = tree.node("TexEnvironment", image=sky(aplanat_bpy, 1))
    gamma = tree.node("Gamma", {"Color": found.outputs[0], "Gamma": 2.0})
    tree.tree.links.new(gamma.outputs[0], node.inputs["Color"])
    reader = ImageReader()
    first, notes = read_world(aplanat_bpy.context.scene.world, reader)
    assert notes == [] and first.image in reader.images
    gamma.inputs["Gamma"].default_value = 0.5
    second, _ = read_world(aplanat_bpy.context.scene.world, reader)
    assert second != first
    bevel = tree.node("Bevel")
    tree.tree.links.new(bevel.outputs[0], gamma.inputs["Gamma"])
    _, notes = read_world(aplanat_bpy.context.scene.world, reader)
    assert notes == ["world 'world': node 'Bevel' is not read; its socket's value is used"]


@pytest.mark.parametrize("how", ["mix of shaders", "mix of colours", "strength"])
def test_a_world_may_light_otherwise_than_the_camera_sees_it(aplanat_bpy, scene, how):
    tree, node = background(aplanat_bpy)
    picture = looked_up(tree, sky(aplanat_bpy, 3))
    ray = tree.node("LightPath").outputs["Is Camera Ray"]
    if how == "mix of shaders":
        seen = tree.node("Background", {"Color": (0.1, 0.2, 0.7)}).outputs[0]
        lighting = tree.node("Background", {"Color": picture}).outputs[0]
        inputs = {"Fac": ray, "Shader": lighting, "Shader_001": seen}
        tree.surface(tree.node("MixShader", inputs).outputs[0])
    elif how == "mix of colours":
        inputs = {"Factor_Float": ray, "A_Color": (0.6, 0.3, 0.1), "B_Color": picture}
        mixed = tree.node("Mix", inputs, data_type="RGBA")
        color = next(s for s in mixed.outputs if s.identifier == "Result_Color")
        tree.surface(tree.node("Background", {"Color": color}).outputs[0])
    else:
        inputs = {"Value": ray, "Value_001": -0.7, "Value_002": 0.9}
        strength = tree.node("Math", inputs, operation="MULTIPLY_ADD").outputs[0]
        inputs = {"Color": picture, "Strength": strength}
        tree.surface(tree.node("Background", inputs).outputs[0])
    assert_like_cycles(scene)


def looked_up(tree, made):
    return tree.node("TexEnvironment", image=made).outputs[0]
