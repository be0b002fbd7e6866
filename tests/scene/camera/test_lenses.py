"""A camera's real lens: found, clamped, and never guessed."""

import pytest

from addon.lens_bokeh.tables.artist_lens import ArtistLens
from addon.lens_io.lens_shelf import LensShelf
from addon.scene.camera.camera import read_camera, sensor_diagonal
from addon.scene.camera.lenses import read_real_lens, user_folder
from addon.scene.extract import SceneExtractor
from addon.snapshot.changes import Change, compare, same_camera
from addon.snapshot.film import Film

FILM = Film(96, 64, (0, 0, 96, 64))


@pytest.fixture
def camera(camera):
    camera.dof.use_dof = True
    camera.dof.focus_distance, camera.dof.aperture_fstop = 4.0, 1.4
    return camera


def read(bpy):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return read_camera(depsgraph, depsgraph.scene.camera, FILM)


def test_a_lens_opens_no_wider_than_it_can(camera, aplanat_bpy):
    thin = read(aplanat_bpy)
    assert thin.real_lens is None
    camera.aplanat.lens = "tessar-50mm-f2.8"
    clamped = read(aplanat_bpy)
    assert clamped.real_lens.id == "tessar-50mm-f2.8"
    assert clamped.real_lens.f_number == 2.8
    assert clamped.lens.aperture_radius == pytest.approx(thin.lens.aperture_radius / 2, rel=1e-6)
    # Blender's own setting is left as the artist made it.
    assert camera.dof.aperture_fstop == pytest.approx(1.4)
    camera.dof.aperture_fstop = 8.0
    assert read(aplanat_bpy).real_lens.f_number == 8.0


def test_a_lens_opens_even_where_the_camera_says_zero(camera, aplanat_bpy):
    camera.dof.aperture_fstop = 0.0
    camera.aplanat.lens = "tessar-50mm-f2.8"
    assert read(aplanat_bpy).lens.aperture_radius == pytest.approx(camera.lens / 5600, rel=1e-6)


def test_an_opening_that_the_lens_has_not_is_told_wherever_it_matters(camera, aplanat_bpy):
    camera.aplanat.lens = "tessar-50mm-f2.8"
    (line,) = read(aplanat_bpy).report
    assert line.startswith("camera 'Camera': asks for f/1.4")
    assert "opens no wider than f/2.8" in line
    # As wide as the lens, but for the rounding of a float property; and without blur.
    camera.dof.aperture_fstop = 2.7999
    assert read(aplanat_bpy).report == ()
    camera.dof.aperture_fstop, camera.dof.use_dof = 1.4, False
    assert read(aplanat_bpy).report == ()


def test_choosing_a_lens_leaves_the_framing_alone(camera, aplanat_bpy):
    camera.lens = 35.0
    before = read(aplanat_bpy).projection
    camera.aplanat.lens = "telephoto-180mm-f2.8"
    assert (read(aplanat_bpy).projection == before).all()
    assert camera.lens == 35.0


def test_a_clamp_restarts_the_picture_and_a_lens_without_effect_does_not(camera, aplanat_bpy):
    def snapshot():
        return SceneExtractor().extract(aplanat_bpy.context.evaluated_depsgraph_get())

    camera.aplanat.bokeh.use = False
    camera.dof.aperture_fstop, camera.dof.use_dof = 4.0, False
    thin = snapshot()
    camera.aplanat.lens = "tessar-50mm-f2.8"
    assert not compare(thin, snapshot()) & Change.CAMERA
    camera.dof.use_dof = True
    closed = snapshot()
    camera.dof.aperture_fstop = 1.4
    wide = snapshot()
    assert compare(closed, wide) & Change.CAMERA
    camera.aplanat.lens = "planar-50mm-f1.4"
    assert compare(wide, snapshot()) & Change.CAMERA


def test_bokeh_is_drawn_anew_for_another_lens_of_the_same_opening(camera, aplanat_bpy):
    camera.dof.aperture_fstop = 4.0
    camera.aplanat.lens = "tessar-50mm-f2.8"
    tessar = read(aplanat_bpy)
    assert same_camera(tessar, read(aplanat_bpy))
    camera.aplanat.lens = "planar-50mm-f1.4"
    planar = read(aplanat_bpy)
    assert (planar.lens, planar.bokeh) == (tessar.lens, tessar.bokeh)
    assert not same_camera(tessar, planar)


def test_zoom_positions_have_their_own_openings(camera, aplanat_bpy):
    camera.aplanat.lens = "zoom-36-69mm-f3.5"
    first = read(aplanat_bpy).real_lens
    assert first.label == first.prescription.labels[0]
    camera.aplanat.zoom_label = first.prescription.labels[-1]
    assert read(aplanat_bpy).real_lens.label == first.prescription.labels[-1]
    camera.aplanat.zoom_label = "70 mm"
    found = read(aplanat_bpy)
    assert found.real_lens.label == first.label
    assert "no zoom position '70 mm'" in found.report[0]
    assert camera.aplanat.zoom_label == "70 mm"


def test_a_lens_that_is_not_there_is_told_and_kept(camera, aplanat_bpy):
    camera.aplanat.lens = "tessar-50mm-f28"
    found = read(aplanat_bpy)
    assert found.real_lens is None
    assert found.lens.aperture_radius == pytest.approx(camera.lens / 2800, rel=1e-6)
    (line,) = found.report
    assert line.startswith("camera 'Camera': lens 'tessar-50mm-f28' is not in the library")
    assert "tessar-50mm-f2.8" in line
    assert camera.aplanat.lens == "tessar-50mm-f28"


def test_a_broken_lens_is_told_with_its_error(camera, tmp_path):
    (tmp_path / "broken.toml").write_text("format = 1")
    camera.aplanat.lens = "broken"
    lens, problems = read_real_lens(camera, LensShelf([tmp_path]))
    assert lens is None
    assert "E03" in problems[0] and "thin lens" in problems[0]


def test_an_orthographic_camera_has_no_real_lens(camera, aplanat_bpy):
    camera.aplanat.lens = "tessar-50mm-f2.8"
    camera.type = "ORTHO"
    found = read(aplanat_bpy)
    assert found.real_lens is None
    assert "perspective" in found.report[0]
    camera.aplanat.lens = "no-such-lens"
    (line,) = read(aplanat_bpy).report
    assert "'no-such-lens' is not in the library" in line and "perspective" not in line


def test_the_users_folder_is_not_in_the_checkout(aplanat_bpy):
    assert user_folder().is_absolute()
    assert user_folder().parts[-2:] == ("aplanat", "lenses")


@pytest.mark.parametrize(
    ("fit", "size", "diagonal"),
    [
        ("AUTO", (3000, 2000), 43.267),
        ("AUTO", (2000, 3000), 43.267),
        ("HORIZONTAL", (2000, 3000), 64.9),
        ("VERTICAL", (3000, 2000), 43.267),
    ],
)
def test_the_diagonal_is_that_of_the_part_of_the_sensor_that_is_used(
    camera, empty_scene, fit, size, diagonal
):
    camera.sensor_width, camera.sensor_height, camera.sensor_fit = 36.0, 24.0, fit
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = size
    assert sensor_diagonal(camera, empty_scene) == pytest.approx(diagonal, abs=0.01)


def test_aberrations_restart_the_picture_and_belong_to_a_thin_lens(camera, aplanat_bpy):
    def snapshot():
        return SceneExtractor().extract(aplanat_bpy.context.evaluated_depsgraph_get())

    camera.dof.use_dof = True
    thin = snapshot()
    assert thin.camera.artist is None
    camera.aplanat.spherical = 2.0
    soft = snapshot()
    assert soft.camera.artist == ArtistLens(spherical=2.0)
    assert compare(thin, soft) & Change.CAMERA
    camera.aplanat.lens = "planar-50mm-f1.4"
    assert snapshot().camera.artist is None
    camera.aplanat.lens, camera.type = "", "ORTHO"
    assert snapshot().camera.artist is None
