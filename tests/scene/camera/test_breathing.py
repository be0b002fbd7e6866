"""Focus breathing: the field of view against thin-lens optics and traced rays."""

import numpy as np
import pytest

from addon.lens_io.lens_shelf import LensShelf
from addon.optics.focus import focused
from addon.optics.glass import REFERENCE_WAVELENGTH_NM
from addon.optics.paraxial import first_order
from addon.optics.rays.trace import Rays, trace
from addon.scene.camera.camera import read_camera, read_pose
from addon.snapshot.film import Film

FILM = Film(96, 64, (0, 0, 96, 64))


@pytest.fixture
def own(camera):
    camera.lens, camera.dof.use_dof, camera.dof.focus_distance = 50.0, True, 0.5
    return camera.aplanat


def read(bpy):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return read_camera(depsgraph, depsgraph.scene.camera, FILM)


def scale(bpy, own):
    """Return how much larger the picture gets when it is switched on."""
    found = []
    for use in (False, True):
        own.use_breathing = use
        found.append(np.diag(read(bpy).projection)[:2])
    assert found[1][0] / found[0][0] == pytest.approx(found[1][1] / found[0][1])
    return found[1][0] / found[0][0]


def test_a_thin_lens_moves_away_from_its_sensor(own, camera, aplanat_bpy):
    camera.shift_x = 0.2
    assert scale(aplanat_bpy, own) == pytest.approx(0.5 / 0.45)
    # The sensor stays where it is shifted to.
    shifted = read(aplanat_bpy).projection[0, 2]
    own.use_breathing = False
    assert shifted == read(aplanat_bpy).projection[0, 2]


def test_a_pose_of_a_neighbouring_frame_breathes_too(own, aplanat_bpy):
    own.use_breathing = True
    found = read(aplanat_bpy)
    depsgraph = aplanat_bpy.context.evaluated_depsgraph_get()
    _, projection = read_pose(depsgraph, depsgraph.scene.camera, FILM)
    assert np.array_equal(projection, found.projection)
    assert found.breathing == pytest.approx(0.5 / 0.45)


@pytest.mark.parametrize("lens", ["double-gauss-50mm-f2", "macro-105mm-f2.8"])
def test_a_real_lens_draws_as_large_as_its_rays(lens, own, camera, aplanat_bpy):
    prescription = LensShelf([]).find(lens).lens.prescription
    configuration = prescription.configuration(None)
    distance, height = 600.0, 1.0
    camera.dof.focus_distance, own.lens = distance / 1000.0, lens
    before, focused_lens = distance, configuration
    for _ in range(8):
        before = distance - first_order(focused_lens).enp_z
        focused_lens = focused(configuration, before, prescription.focus)
    # Near the axis, from a point beside it towards the entrance pupil's middle.
    slope = height / distance
    direction = np.array([[0.0, -slope, 1.0]]) / np.hypot(1.0, slope)
    start = np.array([[0.0, height - slope * before, 0.0]])
    traced = trace(focused_lens, Rays(start, direction), REFERENCE_WAVELENGTH_NM)
    # The whole lens leaves its sensor behind; a focus group leaves it where it was.
    sensor = focused_lens.vertices[-1] + focused_lens.surfaces[-1].thickness
    drawn = abs(float(traced.at_plane(sensor)[0, 1])) / height
    expected = drawn * distance / first_order(configuration).efl
    assert scale(aplanat_bpy, own) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"type": "ORTHO"}, "needs a perspective camera"),
        ({"lens": 600.0}, "nearer than its focal length"),
    ],
)
def test_what_cannot_breathe_says_so(change, told, own, camera, aplanat_bpy):
    for name, value in change.items():
        setattr(camera, name, value)
    assert scale(aplanat_bpy, own) == 1.0
    assert any(told in line for line in read(aplanat_bpy).report)


def test_without_depth_of_field_there_is_none(own, camera, aplanat_bpy):
    camera.dof.use_dof = False
    assert scale(aplanat_bpy, own) == 1.0
    assert read(aplanat_bpy).report == ()
