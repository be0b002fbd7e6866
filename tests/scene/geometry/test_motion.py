"""Motion from the frame before to the frame after, as the Vector pass needs it."""

import math

import numpy as np
import pytest

from addon.scene.extract import SceneExtractor
from tests import scene_builders as scenes


@pytest.fixture
def bpy(aplanat_bpy, empty_scene):
    scenes.look_along_y(aplanat_bpy, 8.0)
    aplanat_bpy.context.view_layer.use_pass_vector = True
    return aplanat_bpy


def extract(bpy, frames=None):
    """Extract frame 5 with its neighbours; `frames` gets the frames that were evaluated."""
    scene = bpy.context.scene

    def frame_set(frame, subframe):
        if frames is not None:
            frames.append((frame, subframe))
        scene.frame_set(frame, subframe=subframe)

    # The scene still holds what was keyed last.
    scene.frame_set(5)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return SceneExtractor().extract(depsgraph, frame_set)


def animate(block, path, values, index=-1):
    """Key a property at frames 4, 5 and 6."""
    for frame, value in zip((4, 5, 6), values, strict=True):
        if index < 0:
            setattr(block, path, value)
        else:
            getattr(block, path)[index] = value
        block.keyframe_insert(path, index=index, frame=frame)


def test_a_moving_object_has_its_places_in_the_neighbouring_frames(bpy):
    data = scenes.cube(bpy)
    moving = scenes.add(bpy, "moving", data)
    animate(moving, "location", (1.0, 2.0, 4.0), 0)
    scenes.add(bpy, "still", data, at=(-3, 0))
    table = extract(bpy).content.instances
    assert table.world[:, 0, 3].tolist() == [2.0, -3.0]
    assert table.previous_world[:, 0, 3].tolist() == [1.0, -3.0]
    assert table.next_world[:, 0, 3].tolist() == [4.0, -3.0]


def test_the_frame_is_set_back(bpy):
    frames = []
    extract(bpy, frames)
    assert frames == [(4, 0.0), (6, 0.0), (5, 0.0)]
    assert bpy.context.scene.frame_current == 5


def test_without_the_vector_pass_no_other_frame_is_evaluated(bpy):
    bpy.context.view_layer.use_pass_vector = False
    frames = []
    snapshot = extract(bpy, frames)
    assert frames == []
    assert snapshot.content.instances.previous_world is None
    assert snapshot.camera.previous is None


def test_the_camera_moves(bpy):
    animate(bpy.context.scene.camera, "location", (1.0, 2.0, 4.0), 0)
    animate(bpy.context.scene.camera.data, "ortho_scale", (2.0, 4.0, 8.0))
    camera = extract(bpy).camera
    for pose, x, scale in ((camera.previous, 1.0, 2.0), (camera.next, 4.0, 8.0)):
        view, projection = pose
        assert view[0, 3] == -x
        assert math.isclose(projection[0, 0], 2.0 / scale, rel_tol=1e-6)


@pytest.mark.parametrize("split", [False, True])
def test_a_deforming_mesh_has_its_other_positions(bpy, split):
    data = scenes.triangle(bpy)
    if split:
        # Two faces that disagree on the colour of the edge they share.
        data = scenes.mesh(
            bpy, "two", [(0, 0, 0), (1, 0, 0), (0, 0, 1), (1, 0, 1)], [(0, 1, 2), (1, 3, 2)]
        )
        tint = data.color_attributes.new("tint", "FLOAT_COLOR", "CORNER")
        for i, element in enumerate(tint.data):
            element.color = (i / 8, 0, 0, 1)
    obj = scenes.add(bpy, "obj", data, scenes.emission(bpy, "paint", (0, 0, 0), attribute="tint"))
    obj.shape_key_add(name="rest")
    key = obj.shape_key_add(name="moved")
    key.data[1].co.x += 2.0
    animate(key, "value", (0.0, 0.5, 1.0))
    content = extract(bpy).content
    (mesh,) = content.meshes.values()
    assert content.groups[0].mesh == mesh.uid
    assert len(mesh.positions) == (6 if split else 3)
    for moved, sign in zip(mesh.motion, (-1, 1), strict=True):
        step = moved - mesh.positions
        at_vertex_1 = np.isclose(step[:, 0], sign, atol=1e-6)
        assert at_vertex_1.sum() == (2 if split else 1)
        assert np.abs(step[~at_vertex_1]).max() < 1e-6


def test_rigid_meshes_have_no_motion_of_their_own(bpy):
    moving = scenes.add(bpy, "moving", scenes.cube(bpy))
    animate(moving, "location", (1.0, 2.0, 4.0), 0)
    # Made anew in every frame, but equal.
    moving.modifiers.new("round", "SUBSURF")
    (mesh,) = extract(bpy).content.meshes.values()
    assert mesh.motion is None


def test_a_mesh_of_changing_topology_does_not_deform(bpy):
    obj = scenes.add(bpy, "building", scenes.cube(bpy))
    build = obj.modifiers.new("build", "BUILD")
    build.frame_start, build.frame_duration = 3, 6
    snapshot = extract(bpy)
    assert all(mesh.motion is None for mesh in snapshot.content.meshes.values())


def test_instances_are_found_again_by_what_made_them(bpy):
    paint = scenes.emission(bpy, "paint", (1, 1, 1))
    points = scenes.instancer(bpy, None, paint, [(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    animate(points, "location", (0.0, 1.0, 3.0), 2)
    table = extract(bpy).content.instances
    assert table.world[:, 0, 3].tolist() == [0.0, 1.0, 2.0]
    assert table.previous_world[:, 0, 3].tolist() == [0.0, 1.0, 2.0]
    assert table.previous_world[:, 2, 3].tolist() == [0.0] * 3
    assert table.next_world[:, 2, 3].tolist() == [3.0] * 3


def test_an_instance_that_comes_or_goes_does_not_move(bpy):
    obj = scenes.add(bpy, "blinking", scenes.cube(bpy), at=(2, 0))
    animate(obj, "hide_viewport", (True, False, True))
    table = extract(bpy).content.instances
    assert np.array_equal(table.previous_world, table.world)
    assert np.array_equal(table.next_world, table.world)


def test_an_empty_scene_has_no_motion(bpy):
    assert extract(bpy).content.instances.previous_world.shape == (0, 4, 4)
