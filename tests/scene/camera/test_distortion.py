"""How a camera's lens bends lines: by a number, and as its traced chief rays do."""

import numpy as np
import pytest

from addon.lens_io.lens_shelf import LensShelf
from addon.optics.distortion import distorted
from addon.optics.rays.aberrations import field_curves
from addon.scene.camera import distortion
from addon.scene.camera.bokeh import corner_tangent
from addon.scene.camera.camera import read_camera
from addon.snapshot.film import Film

FILM = Film(96, 64, (0, 0, 96, 64))
TESSAR = "tessar-50mm-f2.8"


@pytest.fixture
def own(camera):
    camera.lens, camera.sensor_width, camera.sensor_fit = 50.0, 36.0, "HORIZONTAL"
    return camera.aplanat


def read(bpy):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return read_camera(depsgraph, depsgraph.scene.camera, FILM)


def test_by_number_and_without(own, aplanat_bpy):
    own.distortion_k = -0.25
    assert read(aplanat_bpy).distortion == ()
    own.distortion = "DIVISION"
    assert read(aplanat_bpy).distortion == (-0.25,)
    own.distortion_k = 0.0
    assert read(aplanat_bpy).distortion == ()


def test_it_belongs_to_the_lens_and_not_to_the_bokeh(own, aplanat_bpy):
    own.distortion, own.bokeh.use = "DIVISION", False
    found = read(aplanat_bpy)
    assert found.bokeh is None and found.distortion == (pytest.approx(-0.1),)


def test_without_a_real_lens_there_is_none_and_it_says_so(own, aplanat_bpy):
    own.distortion = "LENS"
    found = read(aplanat_bpy)
    assert found.distortion == ()
    assert "has no real lens whose distortion" in found.report[0]


@pytest.mark.parametrize(
    ("lens", "focal_length", "covered"),
    # The Petzval lens covers no more than the middle of the picture.
    [(TESSAR, 50.0, 1.0), ("petzval-51mm-f1.4", 51.0, 0.35), ("retrofocus-35mm-f2.5", 35.0, 1.0)],
)
def test_the_lens_bends_as_its_chief_rays(
    lens, focal_length, covered, own, camera, aplanat_bpy, empty_scene
):
    camera.lens, own.distortion, own.lens = focal_length, "LENS", lens
    found = read(aplanat_bpy)
    assert found.distortion and found.report == ()
    configuration = LensShelf([]).find(lens).lens.prescription.configuration(None)
    corner = corner_tangent(camera, empty_scene)
    fields = np.degrees(np.arctan(np.linspace(0.1, covered, 7) * corner))
    curves = field_curves(configuration, fields)
    ideal = np.tan(np.radians(curves.field_deg)) / corner
    places = distorted(np.stack([ideal, 0.0 * ideal], axis=-1), found.distortion)[:, 0]
    # A tenth of a pixel of a picture 2000 pixels wide.
    assert np.allclose(places, ideal * (1.0 + curves.distortion), rtol=0, atol=1e-4)


def test_a_lens_that_bends_more_than_can_be_drawn_says_so(own, aplanat_bpy, monkeypatch):
    own.lens, own.distortion = TESSAR, "LENS"
    monkeypatch.setattr(distortion, "_terms_of_lens", lambda *_: ((-3.0,), (-0.5,)))
    found = read(aplanat_bpy)
    assert found.distortion == (-0.5,)
    assert "-0.5 is drawn" in found.report[0]


def test_it_grows_with_the_square_of_a_small_picture(own, camera, aplanat_bpy):
    own.lens, own.distortion = TESSAR, "LENS"
    # Small enough for the third order, by which it grows so.
    camera.sensor_width /= 8.0
    wide = read(aplanat_bpy).distortion[0]
    camera.sensor_width /= 2.0
    half = read(aplanat_bpy).distortion[0]
    assert wide / half == pytest.approx(4.0, rel=0.1)
