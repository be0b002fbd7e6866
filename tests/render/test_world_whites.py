"""*Amplify Whites* belongs to the world: bounded, and the same in every method."""

import numpy as np
import pytest

from tests.pictures import render_picture
from tests.surface_scenes import Tree, card_scene, image, world_image


@pytest.fixture
def scene(aplanat_bpy):
    """A camera that looks at a world image of grey and white, with bokeh."""
    bpy = aplanat_bpy
    scene, card, tree = card_scene(bpy, 32)
    tree.surface(tree.node("BsdfDiffuse").outputs[0])
    card.location.z = -3.0
    card.scale = (0.5, 0.5, 1.0)
    camera = scene.camera.data
    camera.type = "PERSP"
    camera.dof.use_dof = True
    camera.dof.focus_distance = 3.0
    scene.render.engine = "APLANAT"
    scene.aplanat.use_target_error = False
    scene.aplanat.render_samples = 4
    return scene


def surround(bpy, value, amplification, is_float=False):
    pixels = np.full((16, 32, 4), 0.25, np.float32)
    pixels[..., 3] = 1.0
    pixels[:, ::2, :3] = value
    world = world_image(bpy, None)
    node = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    made = image(bpy, "sky", pixels, is_float, "Linear Rec.709" if is_float else "Non-Color")
    sky = Tree(world.node_tree, "ShaderNodeOutputWorld").node("TexEnvironment", image=made)
    world.node_tree.links.new(sky.outputs[0], node.inputs["Color"])
    world.aplanat.amplification = amplification


def test_amplified_whites_are_the_same_with_and_without_bokeh_and_in_both_methods(
    scene, aplanat_bpy
):
    surround(aplanat_bpy, 1.0, 100.0)
    means = {}
    for method, bokeh in (("REFERENCE", False), ("ADAPTIVE", False), ("ADAPTIVE", True)):
        scene.aplanat.method = method
        scene.camera.data.aplanat.bokeh.use = bokeh
        picture = render_picture(scene)[..., :3]
        means[method, bokeh] = picture.mean()
        # White is 101 now, half of what is seen, and lights the card: 0.8 (101 + 0.25) / 2.
        assert picture[16, 16] == pytest.approx(40.5, rel=0.02)
    assert min(means.values()) > 40.0
    # Four samples, and the world's highlights drawn as discs.
    assert max(means.values()) < 1.02 * min(means.values())


def test_an_amplified_world_of_high_range_stays_finite(scene, aplanat_bpy):
    surround(aplanat_bpy, 1e30, 10000.0, is_float=True)
    assert np.isfinite(render_picture(scene)).all()
