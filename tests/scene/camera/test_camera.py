import math

import numpy as np
import pytest

from addon.errors import CameraError
from addon.scene.camera.camera import read_camera
from addon.snapshot.film import Film

FILM = Film(96, 64, (0, 0, 96, 64))


@pytest.fixture
def camera(camera, empty_scene):
    camera.dof.use_dof = True
    camera.dof.focus_distance = 4.0
    return empty_scene.camera


def read(bpy, film=FILM):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return read_camera(depsgraph, depsgraph.scene.camera, film)


def test_no_camera_is_named(empty_scene, aplanat_bpy):
    with pytest.raises(CameraError, match="no camera"):
        read(aplanat_bpy)


@pytest.mark.parametrize("kind", ["PANO", "CUSTOM"])
def test_panoramic_and_custom_cameras_are_refused_by_name(camera, aplanat_bpy, kind):
    camera.data.type = kind
    with pytest.raises(CameraError, match=r"camera 'Camera' is \w+; Aplanat renders perspective"):
        read(aplanat_bpy)


def test_the_aperture_follows_focal_length_and_f_stop(camera, aplanat_bpy):
    camera.data.lens = 85.0
    camera.data.dof.aperture_fstop = 1.4
    lens = read(aplanat_bpy).lens
    assert lens.aperture_radius == pytest.approx(0.085 / 2.8, rel=1e-6)
    assert lens.focus_distance == 4.0


def test_an_orthographic_camera_has_the_aperture_of_a_1_m_lens_as_in_cycles(camera, aplanat_bpy):
    camera.data.type = "ORTHO"
    camera.data.dof.aperture_fstop = 2.0
    assert read(aplanat_bpy).lens.aperture_radius == 0.25


def test_a_camera_without_depth_of_field_is_a_pinhole(camera, aplanat_bpy):
    camera.data.dof.use_dof = False
    assert read(aplanat_bpy).lens is None


@pytest.mark.parametrize(
    "setting, value, told",
    [
        ("focus_distance", 0.0, "focus distance is 0 m"),
        ("focus_distance", float("nan"), "focus distance is nan m"),
        ("aperture_fstop", 0.0, "f-stop is 0"),
        ("aperture_ratio", float("nan"), "aperture ratio is nan"),
    ],
)
def test_what_cannot_form_a_picture_is_drawn_sharp_and_told(
    camera, aplanat_bpy, setting, value, told
):
    setattr(camera.data.dof, setting, value)
    found = read(aplanat_bpy)
    assert found.lens is None
    (line,) = found.report
    assert line.startswith("camera 'Camera': ") and told in line and "sharp" in line


def test_a_focus_nearer_than_the_focal_length_is_drawn_and_told(camera, aplanat_bpy):
    camera.data.lens, camera.data.dof.focus_distance = 50.0, 0.049
    found = read(aplanat_bpy)
    assert found.lens.focus_distance == pytest.approx(0.049)
    assert "nearer than its focal length of 0.05 m" in found.report[0]
    camera.data.dof.focus_distance = 0.051
    assert read(aplanat_bpy).report == ()


def focus_on_object(bpy, camera, place):
    target = bpy.data.objects.new("target", None)
    target.location = place
    bpy.context.collection.objects.link(target)
    camera.data.dof.focus_object = target


def test_a_focus_object_behind_the_camera_counts_as_one_in_front_and_is_told(camera, aplanat_bpy):
    focus_on_object(aplanat_bpy, camera, (1.0, 0.0, 3.0))
    found = read(aplanat_bpy)
    assert found.lens.focus_distance == pytest.approx(3.0)
    (line,) = found.report
    assert "focus object 'target' is behind the camera" in line


def test_a_focus_object_in_the_cameras_plane_leaves_everything_sharp(camera, aplanat_bpy):
    focus_on_object(aplanat_bpy, camera, (5.0, 0.0, 0.0))
    found = read(aplanat_bpy)
    assert found.lens is None
    assert "focus distance is 0 m" in found.report[0]


def test_the_view_is_rigid_whatever_the_scale_of_the_camera(camera, aplanat_bpy):
    camera.scale = (2.0, 0.5, -3.0)
    camera.rotation_euler = (1.0, 0.2, -0.4)
    view = read(aplanat_bpy).view[:3, :3]
    assert np.allclose(view @ view.T, np.eye(3), atol=1e-6)


def test_the_projection_frames_the_sensor(camera, aplanat_bpy):
    camera.data.lens, camera.data.sensor_width = 50.0, 36.0
    projection = read(aplanat_bpy).projection
    # Half the field of view: 18 mm at 50 mm; the picture's longer side is fitted.
    assert 1.0 / projection[0, 0] == pytest.approx(18.0 / 50.0, rel=1e-6)
    assert projection[1, 1] / projection[0, 0] == pytest.approx(96 / 64, rel=1e-6)
    assert math.isclose(projection[3, 2], -1.0)
