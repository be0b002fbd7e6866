"""The opening of a camera's lens: one for lens samples and discs."""

import numpy as np
import pytest

from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.pictures import PictureIris
from addon.lens_bokeh.openings.shapes import iris_of, opening_of
from addon.sampling.iris import Iris
from addon.scene.camera.camera import read_camera
from addon.scene.camera.lens_record import record_lens, recorded_opening
from addon.snapshot.film import Film
from tests.lens_bokeh.openings.shapes import heart

FILM = Film(96, 64, (0, 0, 96, 64))
# Opens to f/2.03.
LENS = "double-gauss-50mm-f2"


@pytest.fixture
def camera(camera):
    camera.dof.use_dof = True
    camera.dof.focus_distance = 4.0
    return camera


def read(bpy):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return read_camera(depsgraph, depsgraph.scene.camera, FILM)


def image(bpy, grey, alpha=None):
    made = bpy.data.images.new("iris", *grey.shape[::-1], alpha=True, float_buffer=True)
    made.colorspace_settings.name = "Non-Color"
    pixels = np.ones((*grey.shape, 4), np.float32)
    pixels[..., :3] = grey[..., None]
    if alpha is not None:
        pixels[..., 3] = alpha
    made.pixels.foreach_set(pixels.ravel())
    return made


@pytest.mark.parametrize("bokeh", [True, False])
def test_samples_have_the_opening_of_the_discs_with_and_without_bokeh(camera, bokeh, aplanat_bpy):
    own = camera.aplanat.bokeh
    own.use = bokeh
    camera.dof.aperture_blades, camera.dof.aperture_rotation = 5, 0.25
    camera.dof.aperture_ratio = 2.0
    assert read(aplanat_bpy).lens.iris == Iris(5, 0.25, 2.0)
    own.blade_curvature = 0.5
    found = read(aplanat_bpy)
    assert found.lens.iris == Iris(5, 0.25, 2.0, BladedIris(5, 0.5, 0.25))
    own.iris_image = image(aplanat_bpy, heart(16))
    found = read(aplanat_bpy)
    assert isinstance(found.lens.iris.opening, PictureIris)
    assert found.lens.iris.opening.rotation == 0.25
    assert not found.lens.iris.opening.stop
    if bokeh:
        assert found.bokeh.appearance.iris is found.lens.iris.opening
    assert found.report == ()


def test_a_real_lens_is_round_wide_open_and_shows_its_blades_when_stopped_down(camera, aplanat_bpy):
    camera.dof.aperture_blades, camera.dof.aperture_fstop = 5, 1.4
    # A thin lens has no stop: blades at every f-number, as in Cycles.
    assert read(aplanat_bpy).lens.iris.opening is None
    camera.aplanat.lens = LENS
    found = read(aplanat_bpy)
    opening = opening_of(found.lens.iris)
    assert opening.is_round and found.bokeh.appearance.iris == opening
    camera.dof.aperture_fstop = 2.15
    coming_in = opening_of(read(aplanat_bpy).lens.iris)
    assert not coming_in.is_round and coming_in.blade_radius > 1.0
    camera.dof.aperture_fstop = 5.6
    assert opening_of(read(aplanat_bpy).lens.iris).is_polygon
    camera.aplanat.bokeh.use_round_stop, camera.dof.aperture_fstop = False, 1.4
    assert read(aplanat_bpy).lens.iris == Iris(5)
    camera.aplanat.bokeh.iris_image = image(aplanat_bpy, heart(16))
    assert read(aplanat_bpy).lens.iris.opening.stop


@pytest.mark.parametrize("bokeh", [True, False])
def test_an_image_that_cannot_be_used_is_told_once_and_the_blades_are_drawn(
    camera, bokeh, aplanat_bpy
):
    camera.aplanat.bokeh.use = bokeh
    camera.dof.aperture_blades = 6
    bpy, own = aplanat_bpy, camera.aplanat.bokeh
    missing = bpy.data.images.new("missing", 4, 4)
    missing.source, missing.filepath = "FILE", "//nowhere.png"
    for bad in (image(bpy, np.zeros((4, 4))), missing):
        own.iris_image = bad
        found = read(bpy)
        assert found.lens.iris == Iris(6)
        (line,) = found.report
        assert f"iris image '{bad.name}'" in line and "blades are drawn" in line
    # Without depth of field nothing has its shape.
    camera.dof.use_dof = False
    assert read(bpy).report == ()


def test_a_single_texel_is_a_square_and_what_is_transparent_is_closed(camera, aplanat_bpy):
    own = camera.aplanat.bokeh
    own.iris_image = image(aplanat_bpy, np.ones((1, 1)))
    assert read(aplanat_bpy).lens.iris.opening.area == pytest.approx(4.0)
    own.iris_image = image(aplanat_bpy, np.ones((16, 16)), heart(16))
    found = read(aplanat_bpy).lens.iris.opening
    assert found == PictureIris(heart(16))


def test_of_a_sequence_the_picture_in_the_file_name_is_the_opening(
    camera, aplanat_bpy, empty_scene, tmp_path
):
    bpy = aplanat_bpy
    for frame in (1, 2):
        saved = bpy.data.images.new("saved", 16, 16)
        saved.colorspace_settings.name = "Non-Color"
        pixels = np.zeros((16, 16, 4), np.float32)
        pixels[:, 8 * (frame - 1) :][:, :8, :] = 1.0
        pixels[..., 3] = 1.0
        saved.pixels.foreach_set(pixels.ravel())
        saved.filepath_raw, saved.file_format = str(tmp_path / f"iris_{frame:04d}.png"), "PNG"
        saved.save()
    sequence = bpy.data.images.load(str(tmp_path / "iris_0001.png"))
    sequence.source = "SEQUENCE"
    camera.aplanat.bokeh.iris_image = sequence
    for frame in (1, 2):
        empty_scene.frame_set(frame)
        found = read(bpy)
        assert found.lens.iris.opening.picture[:, :8].min() > 0.0
        assert found.lens.iris.opening.picture[:, 9:].max() == 0.0
        (line,) = found.report
        assert "is animated" in line


def test_a_capture_knows_its_opening(camera, aplanat_bpy):
    own = camera.aplanat.bokeh
    own.blade_curvature = 0.5
    assert recorded_opening(record_lens(camera), 5, 0.2) == BladedIris(5, 0.5, 0.2)
    assert recorded_opening(record_lens(camera), 0, 0.2) == BladedIris()
    own.iris_image = image(aplanat_bpy, heart(16))
    told = record_lens(camera)
    assert recorded_opening(told, 5, 0.2) == PictureIris(heart(16), 0.2)
    told["iris"]["texels"] = "nonsense"
    assert recorded_opening(told, 5, 0.2) == BladedIris(5, 0.5, 0.2)
    assert iris_of(recorded_opening(None, 5, 0.2), 0.2) == Iris(5, 0.2)
