"""Focus on a place that is picked: as deep as the Depth pass says, with any focus object."""

import math

import numpy as np
import pytest

from addon.device import context
from addon.engine.focus_pick import point_of_pixel
from addon.engine.shared_resources import resources
from addon.engine.viewport_session import ViewportSession
from addon.errors import FocusError
from addon.scene.camera.camera import CameraSources, read_camera
from addon.scene.camera.focusing import OFFSET_MARK, depth_along, focus_on, read_depth_of_field
from addon.scene.settings import read_film
from tests.pass_pictures import render_passes
from tests.scene_builders import add, cube, emission, instancer, mesh

# Of the issue.
SHARE = 0.001


@pytest.fixture
def stage(empty_scene, aplanat_bpy):
    """Things of every kind beside one another at their own depths, tilted; below them nothing."""
    bpy, scene = aplanat_bpy, empty_scene
    scene.render.engine = "APLANAT"
    color = emission(bpy, "color", (0.5, 0.5, 0.5))
    things = [add(bpy, "mesh", cube(bpy), color)]
    things.append(instancer(bpy, None, color, [(0, 0, 0.2), (0, 0, -0.3)], name="instances"))
    curve = bpy.data.curves.new("curve", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.25
    line = curve.splines.new("POLY")
    line.points.add(1)
    line.points[0].co, line.points[1].co = (-0.3, 0, -0.3, 1), (0.3, 0, 0.3, 1)
    things.append(add(bpy, "curve", curve, color))
    things.append(add(bpy, "card", _card(bpy, "card"), _cut_out(bpy)))
    things.append(add(bpy, "holdout", _card(bpy, "held"), color))
    things[-1].is_holdout = True
    for i, thing in enumerate(things):
        thing.location = (1.1 * (i - 2), 1.3 * i, 0.2)
        thing.rotation_euler = (0.2, 0.1, 0.3)
    # Behind the hole of the card.
    wall = add(bpy, "wall", _card(bpy, "wall", 6.0), color)
    wall.location = (6.5, 9.0, 0.0)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    camera.location, camera.rotation_euler = (0.3, -8.0, 0.5), (1.5, 0.05, 0.02)
    camera.data.dof.use_dof = True
    scene.camera = camera
    scene.view_layers[0].use_pass_z = True
    return scene


def _card(bpy, name, size=1.0):
    h = size / 2
    data = mesh(bpy, name, [(-h, 0, -h), (h, 0, -h), (h, 0, h), (-h, 0, h)], [(0, 1, 2, 3)])
    data.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    return data


def _cut_out(bpy):
    """A material that is clear in its left half."""
    image = bpy.data.images.new("cut", 8, 8, alpha=True)
    pixels = np.ones((8, 8, 4), np.float32)
    pixels[:, :4, 3] = 0.0
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    material = bpy.data.materials.new("cut out")
    tree = material.node_tree
    node, shader = tree.nodes.new("ShaderNodeTexImage"), tree.nodes["Principled BSDF"]
    node.image = image
    tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])
    return material


def passes_of(scene):
    """Render; return passes by name, bottom row first."""
    passes, _ = render_passes(scene)
    return {name.removeprefix("ViewLayer."): pixels[::-1] for name, pixels in passes.items()}


def test_focus_is_at_the_depth_of_the_depth_pass(stage, aplanat_bpy):
    bpy, scene = aplanat_bpy, stage
    camera = scene.camera
    depth = passes_of(scene)["Depth"][..., 0]
    height, width = depth.shape
    depsgraph = bpy.context.evaluated_depsgraph_get()
    film = read_film(scene)
    seen = read_camera(depsgraph, camera, film, sources=CameraSources())
    context.ensure_context()
    session = ViewportSession(resources(), None)
    found, empty = {}, []
    for y in np.linspace(2, height - 3, 12).astype(int):
        for x in np.linspace(2, width - 3, 24).astype(int):
            point = point_of_pixel(session, depsgraph, seen, film, int(x), int(y))
            if depth[y, x] >= 1e10:
                assert point is None
                empty.append((x, y))
                continue
            found[x, y] = focus_on(scene, camera, point)
            assert found[x, y] == pytest.approx(depth[y, x], rel=SHARE)
            assert camera.data.dof.focus_distance == pytest.approx(depth[y, x], rel=SHARE)
    assert len(found) >= 20 and len(empty) >= 10
    # On everything that is there; a holdout has no depth, it is a hole in the picture.
    things = {"mesh", "instances", "curve", "card", "wall"}
    assert set(_things_at(bpy, found, scene, depsgraph)) >= things
    assert "holdout" in set(_things_at(bpy, empty, scene, depsgraph))


def _things_at(bpy, found, scene, depsgraph):
    camera = scene.camera
    origin = camera.matrix_world.translation
    corners = camera.data.view_frame(scene=scene)
    film = read_film(scene)
    for x, y in found:
        right, low, left = corners[0], corners[2], corners[2]
        at = low.copy()
        at.x = left.x + (x + 0.5) / film.width * (right.x - left.x)
        at.y = low.y + (y + 0.5) / film.height * (right.y - low.y)
        way = (camera.matrix_world @ at - origin).normalized()
        hit, _, _, _, thing, _ = scene.ray_cast(depsgraph, origin, way)
        yield thing.name if hit else ""


def test_a_camera_goes_on_following_from_the_place(stage, aplanat_bpy):
    from mathutils import Matrix

    bpy, scene = aplanat_bpy, stage
    camera, followed = scene.camera, bpy.data.objects["mesh"]
    camera.data.dof.focus_object = followed
    bpy.context.view_layer.update()
    place = followed.matrix_world @ Matrix.Translation((0.1, -0.3, 0.2)).translation
    distance = focus_on(scene, camera, place)
    empty = camera.data.dof.focus_object
    assert OFFSET_MARK in empty and empty.parent == followed
    for move in ((0.0, 0.0, 0.0), (0.0, 2.0, 0.5)):
        followed.location = [a + b for a, b in zip(followed.location, move, strict=True)]
        bpy.context.view_layer.update()
        blur = read_depth_of_field(bpy.context.evaluated_depsgraph_get(), camera)
        place.y, place.z = place.y + move[1], place.z + move[2]
        assert blur.focus_distance == pytest.approx(depth_along(camera, place), rel=1e-5)
    assert distance != pytest.approx(blur.focus_distance)
    # The same empty serves the next place.
    focus_on(scene, camera, place)
    assert camera.data.dof.focus_object == empty
    focus_on(scene, camera, place, follow=False)
    assert camera.data.dof.focus_object is None


def test_a_bone_is_followed_from_the_place(stage, aplanat_bpy):
    from mathutils import Matrix

    bpy, scene = aplanat_bpy, stage
    bpy.ops.object.armature_add(location=(0.5, 1.0, 0.0), rotation=(0.3, 0.2, 0.1))
    rig, camera = bpy.context.object, scene.camera
    camera.data.dof.focus_object, camera.data.dof.focus_subtarget = rig, "Bone"
    bpy.context.view_layer.update()
    place = rig.matrix_world @ rig.pose.bones["Bone"].matrix @ Matrix.Translation((0, 0.4, 0.1))
    focus_on(scene, camera, place.translation)
    bpy.context.view_layer.update()
    empty = camera.data.dof.focus_object
    assert np.allclose(empty.matrix_world.translation, place.translation, atol=1e-5)
    rig.pose.bones["Bone"].rotation_mode = "XYZ"
    rig.pose.bones["Bone"].rotation_euler = (0.7, 0.0, 0.0)
    bpy.context.view_layer.update()
    moved = rig.matrix_world @ rig.pose.bones["Bone"].matrix @ Matrix.Translation((0, 0.4, 0.1))
    assert np.allclose(empty.matrix_world.translation, moved.translation, atol=1e-5)


def test_what_is_behind_the_camera_is_not_focused_on(stage):
    camera = stage.camera
    before = camera.data.dof.focus_distance
    with pytest.raises(FocusError, match="behind the camera"):
        focus_on(stage, camera, (0.0, -20.0, 0.0))
    assert camera.data.dof.focus_distance == before


def test_depth_of_field_is_in_pixels_of_the_picture(stage, aplanat_bpy):
    bpy, camera = aplanat_bpy, stage.camera
    data = camera.data
    data.lens, data.dof.aperture_fstop, data.dof.focus_distance = 50.0, 2.0, 4.0
    stage.view_layers[0].aplanat.use_pass_coc = True
    passes = passes_of(stage)
    blur = read_depth_of_field(bpy.context.evaluated_depsgraph_get(), camera)
    shown = passes["Depth"] < 1e10
    expected = 0.5 * blur.diameter(passes["Depth"][shown])
    assert np.allclose(passes["CoC"][shown], expected, rtol=1e-3)
    assert math.isfinite(blur.reach)


def test_a_focus_pull_sets_two_eased_keys(stage, aplanat_bpy):
    bpy, data = aplanat_bpy, stage.camera.data
    data.dof.focus_object = bpy.data.objects["mesh"]
    # Keys of before stay as they are.
    data.dof.focus_distance = 9.0
    data.keyframe_insert("dof.focus_distance", frame=1)
    done = bpy.ops.view3d.aplanat_focus_pull(
        "EXEC_DEFAULT", start=10, length=20, easing="STRONG", first=2.0, second=6.0
    )
    assert done == {"FINISHED"} and data.dof.focus_object is None
    distances = []
    for frame in (1, 10, 15, 20, 30):
        stage.frame_set(frame)
        distances.append(data.dof.focus_distance)
    assert distances == pytest.approx([9.0, 2.0, 2.25, 4.0, 6.0], abs=1e-4)
    cancelled = bpy.ops.view3d.aplanat_focus_pull("EXEC_DEFAULT", first=0.0, second=1.0)
    assert cancelled == {"CANCELLED"}


def test_picking_sets_a_key_where_blender_sets_keys_by_itself(stage, aplanat_bpy):
    bpy, data = aplanat_bpy, stage.camera.data
    place = bpy.data.objects["mesh"].matrix_world.translation
    bpy.ops.view3d.aplanat_focus_pick("EXEC_DEFAULT", point=place)
    assert data.animation_data is None
    stage.tool_settings.use_keyframe_insert_auto = True
    bpy.ops.view3d.aplanat_focus_pick("EXEC_DEFAULT", point=place)
    assert data.animation_data.action is not None
