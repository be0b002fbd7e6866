"""Framing, defocus size and iris orientation against Cycles' camera.

The referee is Cycles with a box filter of one pixel, no bounces and no denoising, rendered in the
test. The scene is emissive and flat, so both engines see the same surfaces; what is left between
them is sampling noise, which sets the tolerances.
"""

import math

import numpy as np
import pytest

from benchmarks.scenes.materials import emission
from tests.pictures import energy_ratio, render_aplanat, render_cycles, ssim

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

FOCUS = 5.0


def add_quad(bpy, name, center, size, color, strength=1.0):
    """Add a square that faces down the y axis, towards the camera."""
    x, y, z = center
    mesh = bpy.data.meshes.new(name)
    half = size / 2
    corners = [(-half, 0, -half), (half, 0, -half), (half, 0, half), (-half, 0, half)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.materials.append(emission(bpy, name, color, strength))
    quad = bpy.data.objects.new(name, mesh)
    quad.location = (x, y, z)
    bpy.context.collection.objects.link(quad)
    return quad


def add_camera(bpy, scene, **properties):
    """Add a camera at the origin that looks along +y, focused at 5 m."""
    data = bpy.data.cameras.new("Camera")
    camera = bpy.data.objects.new("Camera", data)
    camera.rotation_euler = (math.pi / 2, 0, 0)
    bpy.context.collection.objects.link(camera)
    scene.camera = camera
    data.clip_start, data.clip_end = 0.05, 200.0
    data.dof.use_dof = True
    data.dof.focus_distance = FOCUS
    data.dof.aperture_fstop = 0.4
    for name, value in properties.items():
        target = data.dof if hasattr(data.dof, name) else data
        setattr(target, name, value)
    return camera


@pytest.fixture
def lights_scene(empty_scene, aplanat_bpy):
    """Bright squares in front of and behind the focus, off the axis and unlike each other."""
    bpy = aplanat_bpy
    add_quad(bpy, "wall", (0, 60, 0), 120, (0.02, 0.03, 0.05))
    add_quad(bpy, "subject", (0.25, FOCUS, -0.4), 0.9, (0.5, 0.3, 0.1))
    add_quad(bpy, "near_a", (-0.32, 2.2, 0.16), 0.02, (1.0, 0.7, 0.3), 400.0)
    add_quad(bpy, "near_b", (0.28, 2.6, 0.22), 0.02, (0.3, 1.0, 0.4), 300.0)
    add_quad(bpy, "far_a", (-2.0, 14, -0.9), 0.10, (0.4, 0.6, 1.0), 400.0)
    add_quad(bpy, "far_b", (1.6, 12, 1.9), 0.10, (1.0, 0.4, 0.5), 400.0)
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = 120, 90
    return empty_scene


@pytest.mark.parametrize(
    "iris",
    [
        {"aperture_blades": 3, "aperture_rotation": 0.4},
        {"aperture_blades": 3, "aperture_rotation": 0.4, "aperture_ratio": 2.0},
        {"aperture_blades": 5, "aperture_rotation": -0.7, "aperture_ratio": 0.6},
        {"aperture_blades": 2},
    ],
    ids=["three blades", "three blades, ratio 2", "five blades, ratio 0.6", "two blades are round"],
)
def test_iris_orientation_in_front_and_behind_agrees_with_cycles(lights_scene, aplanat_bpy, iris):
    add_camera(aplanat_bpy, lights_scene, **iris)
    ours = render_aplanat(lights_scene, 512)
    cycles = render_cycles(lights_scene, 1024)
    # The bar; noise of 1024 Cycles samples alone costs about 0.003.
    assert ssim(ours, cycles) >= 0.98
    # Two runs of either engine differ by about 1 % for these few squares, smaller than two pixels.
    assert energy_ratio(ours, cycles) == pytest.approx(1.0, abs=0.025)


def test_an_asymmetric_iris_is_mirrored_behind_the_focus(empty_scene, aplanat_bpy):
    """The same iris shape appears upside down on the other side of the focus plane."""
    camera = add_camera(aplanat_bpy, empty_scene, aperture_blades=3, aperture_rotation=math.pi / 2)
    camera.data.dof.aperture_fstop = 0.1
    empty_scene.render.resolution_x = empty_scene.render.resolution_y = 128
    quad = add_quad(aplanat_bpy, "point", (0, 2.5, 0), 0.01, (1, 1, 1), 1000.0)
    near = render_aplanat(empty_scene, 256)[..., 0]
    quad.location.y = 150.0
    quad.scale = (60.0,) * 3
    far = render_aplanat(empty_scene, 256)[..., 0]
    rows = np.arange(128) + 0.5
    # One side of the triangle lies up and one corner down, or the reverse: where most light is
    # relative to the middle of its extent tells which.
    skew = []
    for picture in (near, far):
        lit = np.flatnonzero(picture.sum(axis=1) > picture.sum() * 1e-3) + 0.5
        centroid = (picture.sum(axis=1) * rows).sum() / picture.sum()
        skew.append(centroid - (lit[0] + lit[-1]) / 2)
    assert abs(skew[0]) > 1.0 and abs(skew[1]) > 1.0
    assert skew[0] * skew[1] < 0


@pytest.mark.parametrize(
    "properties, resolution",
    [
        ({"shift_x": 0.2, "shift_y": -0.15}, (120, 90)),
        ({"sensor_fit": "VERTICAL", "sensor_height": 20.0}, (120, 90)),
        ({"sensor_fit": "HORIZONTAL"}, (70, 110)),
        ({"sensor_fit": "AUTO", "shift_y": 0.1}, (70, 110)),
        ({"type": "ORTHO", "ortho_scale": 5.0, "aperture_fstop": 3.0, "shift_x": 0.1}, (120, 90)),
        ({"lens": 24.0, "aperture_fstop": 0.15}, (120, 90)),
    ],
    ids=["shift", "vertical fit", "horizontal fit", "auto fit, portrait", "orthographic", "wide"],
)
def test_framing_agrees_with_cycles(lights_scene, aplanat_bpy, properties, resolution):
    add_camera(aplanat_bpy, lights_scene, **properties)
    lights_scene.render.resolution_x, lights_scene.render.resolution_y = resolution
    ours = render_aplanat(lights_scene, 400)
    cycles = render_cycles(lights_scene, 800)
    assert ssim(ours, cycles) >= 0.98


def test_pixel_aspect_agrees_with_cycles(lights_scene, aplanat_bpy):
    add_camera(aplanat_bpy, lights_scene)
    lights_scene.render.pixel_aspect_x = 2.0
    assert ssim(render_aplanat(lights_scene, 400), render_cycles(lights_scene, 800)) >= 0.98


def test_a_moved_scaled_and_parented_camera_agrees_with_cycles(lights_scene, aplanat_bpy):
    camera = add_camera(aplanat_bpy, lights_scene)
    parent = aplanat_bpy.data.objects.new("rig", None)
    parent.scale = (1.0, 2.5, 0.5)
    parent.rotation_euler = (0.05, 0.1, -0.08)
    aplanat_bpy.context.collection.objects.link(parent)
    camera.parent = parent
    camera.scale = (3.0, 3.0, 3.0)
    camera.location = (0.1, -0.2, 0.1)
    assert ssim(render_aplanat(lights_scene, 400), render_cycles(lights_scene, 800)) >= 0.98


def test_focus_object_beside_the_axis_focuses_its_plane(lights_scene, aplanat_bpy):
    """Blender measures the distance along the axis, not to the object."""
    target = aplanat_bpy.data.objects.new("target", None)
    target.location = (4.0, 12.0, 2.0)
    aplanat_bpy.context.collection.objects.link(target)
    camera = add_camera(aplanat_bpy, lights_scene)
    camera.data.dof.focus_object = target
    by_object = render_aplanat(lights_scene, 32)
    camera.data.dof.focus_object = None
    camera.data.dof.focus_distance = 12.0
    # The rotation to look along y is not exact in floats: the distances differ in the last digits.
    assert np.abs(render_aplanat(lights_scene, 32) - by_object).max() < 1e-2


def test_focus_bone_agrees_with_cycles(lights_scene, aplanat_bpy):
    bpy = aplanat_bpy
    armature = bpy.data.armatures.new("rig")
    rig = bpy.data.objects.new("rig", armature)
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.edit_bones.new("far")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.location = (1.0, 3.0, 0.5)
    rig.pose.bones["far"].location = (0.0, 0.0, 0.0)
    rig.rotation_euler = (0.3, 0.0, 0.2)
    rig.pose.bones["far"].location = (0.3, 1.0, -9.0)
    camera = add_camera(bpy, lights_scene)
    camera.data.dof.focus_object = rig
    camera.data.dof.focus_subtarget = "far"
    assert ssim(render_aplanat(lights_scene, 400), render_cycles(lights_scene, 800)) >= 0.98


def test_blackman_harris_filter_agrees_with_cycles(lights_scene, aplanat_bpy):
    add_camera(aplanat_bpy, lights_scene, use_dof=False)
    # Squares 400 times brighter than white would show the noise of the filter's faintest rim.
    for material in aplanat_bpy.data.materials:
        emission = next(node for node in material.node_tree.nodes if node.type == "EMISSION")
        emission.inputs["Strength"].default_value = 1.0
    ours = render_aplanat(lights_scene, 256, "BLACKMAN_HARRIS", 1.5)
    cycles = render_cycles(lights_scene, 512, "BLACKMAN_HARRIS", 1.5)
    assert ssim(ours, cycles) >= 0.995
    wide = render_aplanat(lights_scene, 256, "BLACKMAN_HARRIS", 4.0)
    assert ssim(wide, render_cycles(lights_scene, 512, "BLACKMAN_HARRIS", 4.0)) >= 0.995
    assert ssim(wide, cycles) < 0.99
