"""Skies of a world are those of Cycles, and light what is in front of them."""

import math

import numpy as np
import pytest

from tests.pictures import render_aplanat, render_cycles
from tests.surface_scenes import TINY_FILTER, Tree, card_scene, world_image

SKIES = {
    "multiple": ({"sky_type": "MULTIPLE_SCATTERING", "sun_elevation": 0.4}, 0.1),
    "single": ({"sky_type": "SINGLE_SCATTERING", "sun_elevation": 0.4, "altitude": 2000.0}, 0.1),
    "preetham": ({"sky_type": "PREETHAM", "turbidity": 3.0, "sun_direction": (0.2, 0.7, 0.5)}, 0.5),
    "hosek": ({"sky_type": "HOSEK_WILKIE", "sun_direction": (0.2, 0.7, 0.5)}, 2.0),
}


def sky_scene(bpy, settings, strength):
    """A wide view over the horizon towards +y, with a small matt card in its middle."""
    scene, card, tree = card_scene(bpy, 24)
    tree.surface(tree.node("BsdfDiffuse", {"Color": (0.8, 0.8, 0.8)}).outputs[0])
    card.location = (0.0, 0.0, -3.0)
    card.scale = (0.4, 0.4, 1.0)
    scene.camera.data.type, scene.camera.data.lens = "PERSP", 16.0
    scene.camera.rotation_euler = (1.7, 0.0, 0.3)
    world = world_image(bpy, None)
    node = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    tree = Tree(world.node_tree, "ShaderNodeOutputWorld")
    sky = tree.node("TexSky", **{"sun_disc": False, **settings})
    tree.tree.links.new(sky.outputs[0], node.inputs["Color"])
    node.inputs["Strength"].default_value = strength
    return scene, sky, node


@pytest.mark.parametrize("name", SKIES)
def test_a_sky_is_that_of_cycles(aplanat_bpy, name):
    scene, *_ = sky_scene(aplanat_bpy, *SKIES[name])
    ours = render_aplanat(scene, 1)
    cycles = render_cycles(scene, 1, "BLACKMAN_HARRIS", TINY_FILTER)
    difference = np.abs(ours - cycles)[..., :3]
    assert cycles[..., :3].std() > 0.02
    # Two rows of pixels at the horizon, where the sky changes within a texel of the image.
    assert np.sort(difference.max(axis=2).ravel())[-48] < 0.008
    assert difference.mean() < 0.003


@pytest.mark.parametrize("kind", ["MULTIPLE_SCATTERING", "SINGLE_SCATTERING"])
def test_the_disc_of_the_sun_is_that_of_cycles(aplanat_bpy, kind):
    """Darker at its edge, redder below, and cut by the horizon."""
    settings = {"sky_type": kind, "sun_disc": True, "sun_size": 0.8, "sun_elevation": 0.3}
    scene, *_ = sky_scene(aplanat_bpy, settings, 0.003)
    ours = render_aplanat(scene, 1)[..., :3]
    cycles = render_cycles(scene, 1, "BLACKMAN_HARRIS", TINY_FILTER)[..., :3]
    assert 20 < (cycles[..., 1] > 0.3).sum() < 400
    # Its edge lies between texels of the image.
    difference = np.sort(np.abs(ours - cycles).max(axis=2).ravel())
    assert difference[-40] < 0.02
    assert np.allclose(ours.mean(axis=(0, 1)), cycles.mean(axis=(0, 1)), rtol=0.02)


@pytest.mark.parametrize("height_of_sun", [0.35, 0.5, 0.7, 1.2])
def test_a_small_disc_has_the_energy_of_a_large_one(height_of_sun):
    """The disc is antialiased: however small and wherever it is, its light is the sun's."""
    from addon.scene.skies.sky_image import Sky, sky_xyz

    sun = (0.0, math.cos(height_of_sun), math.sin(height_of_sun))
    energy = []
    for size in (0.06, 0.0095):
        sky = sky_xyz(Sky("MULTIPLE_SCATTERING", sun, disc=size))
        dark = sky_xyz(Sky("MULTIPLE_SCATTERING", sun, disc=size, intensity=0.0))
        height, width = sky.shape[:2]
        elevation = ((np.arange(height) + 0.5) / height - 0.5) * np.pi
        texel = 2.0 * np.pi / width * np.pi / height * np.cos(elevation)
        energy.append(((sky - dark)[..., 1] * texel[:, None]).sum())
    assert energy[1] == pytest.approx(energy[0], rel=0.01)


def test_a_sky_is_computed_once_until_it_changes(aplanat_bpy, monkeypatch):
    from addon.scene.images.images import ImageReader
    from addon.scene.nodes import image_nodes
    from addon.scene.shading.world import read_world

    calls = []
    compute = image_nodes.sky_xyz
    monkeypatch.setattr(image_nodes, "sky_xyz", lambda sky: calls.append(sky) or compute(sky))
    scene, sky, _ = sky_scene(aplanat_bpy, *SKIES["multiple"])
    reader = ImageReader()
    images = []
    for elevation in (0.4, 0.4, 0.5):
        sky.sun_elevation = elevation
        reader.begin()
        world, notes = read_world(scene.world, reader)
        images.append(world.image)
        assert not notes
    assert images[0] == images[1] != images[2]
    assert len(calls) == 2
