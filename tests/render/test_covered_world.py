"""Highlights of the world behind surfaces as good as infinitely far: the lens sees them alike.

Compared with lens samples, which draw the world behind the scene as everything else.
"""

import math

import numpy as np
import pytest

from addon.engine.shared_resources import listen
from tests.surface_scenes import Tree

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

SUN = 5000.0


@pytest.fixture
def scene(empty_scene, aplanat_bpy):
    """A small sun in the world's image, far out of focus."""
    bpy, scene = aplanat_bpy, empty_scene
    picture = bpy.data.images.new("sky", 256, 128, float_buffer=True)
    pixels = np.full((128, 256, 4), 0.1, np.float32)
    # Straight ahead.
    pixels[63:66, 63:66] = SUN
    pixels[..., 3] = 1.0
    picture.pixels.foreach_set(pixels.ravel())
    scene.world = bpy.data.worlds.new("sky")
    tree = Tree(scene.world.node_tree)
    found = tree.node("TexEnvironment", image=picture)
    background = scene.world.node_tree.nodes["Background"]
    scene.world.node_tree.links.new(found.outputs[0], background.inputs["Color"])
    data = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(scene.camera)
    data.clip_end = 1e5
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 2.0, 0.3
    own = scene.aplanat
    own.method, own.use_target_error, own.render_samples = "ADAPTIVE", False, 16
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    return scene


def light_of(scene, bokeh):
    """Return the mean of a final render."""
    import bpy

    scene.render.engine = "APLANAT"
    scene.camera.data.aplanat.bokeh.use = bokeh
    with listen(keep_pictures=True) as heard:
        bpy.ops.render.render(scene=scene.name)
    assert heard.error is None
    return float(heard.layers[0].passes["Combined"].pixels[..., :3].mean())


def add_wall(bpy, distance, through):
    """Fill the view with a surface that lets a share of the light through."""
    turned = (math.pi / 2, 0.0, 0.0)
    bpy.ops.mesh.primitive_plane_add(
        size=3.0 * distance, location=(0.0, distance, 0.0), rotation=turned
    )
    material = bpy.data.materials.new("wall")
    material.node_tree.nodes.clear()
    tree = Tree(material.node_tree)
    grey = tree.node("Emission", {"Color": (0.2, 0.2, 0.2, 1.0)}).outputs[0]
    if through:
        clear = tree.node("BsdfTransparent").outputs[0]
        parts = {"Fac": through, "Shader": grey, "Shader_001": clear}
        grey = tree.node("MixShader", parts).outputs[0]
    material.node_tree.links.new(grey, tree.output.inputs[0])
    bpy.context.object.data.materials.append(material)


@pytest.mark.parametrize("distance", [10.0, 5000.0])
@pytest.mark.parametrize("through", [0.0, 0.5])
def test_the_sun_behind_a_wall(scene, aplanat_bpy, distance, through):
    free = light_of(scene, bokeh=True)
    assert free > 40.0
    add_wall(aplanat_bpy, distance, through)
    found, sampled = (light_of(scene, bokeh=bokeh) for bokeh in (True, False))
    assert found == pytest.approx(sampled, rel=0.15 if through else 1e-4)
    assert found == pytest.approx(through * free, abs=0.03 * free + 0.3)
