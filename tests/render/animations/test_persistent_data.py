"""With Persistent Data nothing that did not change is sent again, and each frame has its bits."""

import math

import numpy as np
import pytest

from addon.engine.shared_resources import listen, resources
from tests.surface_scenes import Tree

SIZE = (64, 36)


@pytest.fixture
def scene(aplanat_bpy):
    """Two balls, one of them painted, before an image as world; the camera moves."""
    bpy = aplanat_bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "APLANAT"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    settings = scene.aplanat
    settings.method, settings.use_target_error, settings.least_triangles = "ADAPTIVE", False, 64
    settings.render_samples = 4
    for number, name in enumerate(("painted", "moved")):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=64, ring_count=32, location=(2.0 * number - 1.0, 9.0, 0.0)
        )
        bpy.context.object.name = name
        material = bpy.data.materials.new(name)
        bpy.context.object.data.materials.append(material)
        material.node_tree.nodes.clear()
        tree = Tree(material.node_tree)
        image = tree.node("TexImage", image=_image(bpy, name))
        glow = tree.node("Emission", {"Color": image.outputs["Color"]})
        tree.tree.links.new(glow.outputs[0], tree.output.inputs["Surface"])
    scene.world = bpy.data.worlds.new("world")
    scene.world.node_tree.nodes.clear()
    sky = Tree(scene.world.node_tree, "ShaderNodeOutputWorld")
    image = sky.node("TexEnvironment", image=_image(bpy, "sky"))
    glow = sky.node("Background", {"Color": image.outputs["Color"]})
    sky.tree.links.new(glow.outputs[0], sky.output.inputs["Surface"])
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.rotation_euler.x = math.radians(90)
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = 0.5, 0.3
    scene.collection.objects.link(camera)
    scene.camera = camera
    for frame in (1, 10):
        camera.location.x = 0.1 * frame
        camera.keyframe_insert("location", frame=frame)
    return scene


def _image(bpy, name):
    image = bpy.data.images.new(name, 16, 8)
    image.pixels = np.random.default_rng(len(name)).uniform(size=(8, 16, 4)).ravel()
    return image


@pytest.fixture
def session(scene):
    """The session of a command that renders several frames."""
    with resources().open_session() as session:
        yield session


def frame(bpy, scene, number, session=None):
    """Render a frame; return its bits and what was sent to the device for it."""
    scene.frame_set(number)
    scene.render.use_persistent_data = session is not None
    with listen(keep_pictures=True, session=session) as heard:
        bpy.ops.render.render()
    if heard.error:
        raise heard.error
    (layer,) = heard.layers
    pixels = layer.passes["Combined"].pixels
    return pixels.tobytes(), {k: n for k, n in heard.statistics.uploads.items() if n}


def test_a_moving_camera_sends_nothing_again(aplanat_bpy, scene, session):
    numbers = (1, 2, 3)
    kept = [frame(aplanat_bpy, scene, number, session) for number in numbers]
    assert kept[0][1]["meshes"] == 2 and kept[0][1]["levels"] == 2
    assert kept[0][1]["images"] == 3 and kept[0][1]["environments"] == 1
    assert [sent for _, sent in kept[1:]] == [{}, {}]
    # As if each frame were the only one.
    alone = [frame(aplanat_bpy, scene, number) for number in numbers]
    assert [bits for bits, _ in kept] == [bits for bits, _ in alone]
    assert alone[2][1] == kept[0][1]


def _stretch(scene):
    mesh = scene.objects["moved"].data
    for vertex in mesh.vertices:
        vertex.co.z *= 1.5
    mesh.update()


def _move(scene):
    scene.objects["moved"].location.z += 0.5


def _paint(scene):
    image = scene.objects["painted"].material_slots[0].material.node_tree.nodes[1].image
    image.pixels = np.full(16 * 8 * 4, 0.25, np.float32)


def _bend(scene):
    scene.objects["moved"].modifiers.new("bend", "SIMPLE_DEFORM").angle = 1.0


def _hide(scene):
    scene.objects["painted"].hide_render = True


def _darken(scene):
    nodes = scene.world.node_tree.nodes
    next(n for n in nodes if n.type == "BACKGROUND").inputs["Strength"].default_value = 0.3


@pytest.mark.parametrize("change", [_stretch, _move, _paint, _bend, _hide, _darken])
def test_what_changed_is_seen(aplanat_bpy, scene, session, change):
    before, _ = frame(aplanat_bpy, scene, 1, session)
    change(scene)
    after, _ = frame(aplanat_bpy, scene, 1, session)
    fresh, _ = frame(aplanat_bpy, scene, 1)
    assert after != before
    assert after == fresh
