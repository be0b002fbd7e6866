"""A camera's chromatic aberration: read at the evaluated frame, kept while nothing changes."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from addon.lens_io.glasses.dispersion import glass_dispersion, lens_dispersion
from addon.sampling.equalizer import FLAT
from addon.scene.camera import drawn_curves
from addon.scene.camera.camera import read_camera
from addon.scene.camera.chromatic import LATERAL_UNIT
from addon.scene.camera.drawn_curves import EQUALIZER, SAMPLES, curve_values
from addon.scene.extract import SceneExtractor
from addon.scene.view import read_view
from addon.snapshot.changes import Change, compare
from addon.snapshot.film import Film
from addon.ui.operators.chromatic_curves import set_points

FILM = Film(96, 64, (0, 0, 96, 64))
TESSAR = "tessar-50mm-f2.8"
# Blender's float properties have 32 bits.
SINGLE = 1e-6
CURVE_PATH = 'nodes["Axial First"].mapping.curves[0].points[1].location'


@pytest.fixture
def camera(camera):
    camera.dof.use_dof = True
    camera.dof.focus_distance = 4.0
    camera.aplanat.chromatic.use = True
    return camera


@pytest.fixture
def chromatic(camera):
    return camera.aplanat.chromatic


def read_whole(bpy):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return read_camera(depsgraph, depsgraph.scene.camera, FILM)


def read_through_camera(bpy):
    """What a viewport in camera view reads."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = depsgraph.scene.camera
    region = SimpleNamespace(width=96, height=64)
    region_3d = SimpleNamespace(
        view_perspective="CAMERA",
        window_matrix=camera.calc_matrix_camera(depsgraph, x=96, y=64),
        view_matrix=camera.matrix_world.inverted(),
    )
    return read_view(depsgraph, SimpleNamespace(camera=camera), region, region_3d, 1).camera


def read(bpy):
    return read_whole(bpy).chromatic


def at_frame(bpy, frame):
    bpy.context.scene.frame_set(frame)
    return read(bpy)


def test_a_camera_is_achromatic_until_it_is_switched_on(chromatic, aplanat_bpy):
    chromatic.use = False
    chromatic.glass = "no such glass"
    whole = read_whole(aplanat_bpy)
    assert whole.chromatic is None and whole.report == ()


def test_the_settings_of_a_new_camera_are_those_of_the_paper(camera, aplanat_bpy):
    found = read(aplanat_bpy)
    assert found.mode == "SPECTRAL" and found.wavelength_range == (380.0, 780.0)
    assert found.axial == 1.0 and found.lateral == LATERAL_UNIT
    assert found.dispersion == glass_dispersion("N-BK7")
    assert found.focal_length == camera.lens / 1000.0
    assert found.axial_map(0.3) == 0.3 and found.lateral_map(0.3) == 0.3
    assert found.equalizer is FLAT
    assert found.primaries == "ITU-R BT.709"


def test_what_is_set_is_what_is_read(camera, chromatic, aplanat_bpy):
    chromatic.mode, chromatic.axial, chromatic.lateral = "RGB", -2.0, -3.0
    chromatic.glass = "F2"
    chromatic.axial_first, chromatic.axial_then = "T3", "EXP"
    chromatic.lateral_first, chromatic.lateral_then = "COS_T", "T_COS_THETA"
    camera.lens = 85.0
    found = read(aplanat_bpy)
    assert (found.mode, found.axial, found.lateral) == ("RGB", -2.0, -3.0 * LATERAL_UNIT)
    assert found.dispersion == glass_dispersion("F2")
    assert found.axial_map(0.5) == pytest.approx(math.exp(0.125))
    assert found.lateral_map(1.0, math.pi) == pytest.approx(-1.0)
    assert found.focal_length == pytest.approx(0.085, rel=SINGLE)
    # Between green, which alone would be 510 nm, and red.
    assert 510.0 < found.reference_nm < 550.0 and not found.of_lens
    chromatic.focus_light = "LONGEST"
    assert read(aplanat_bpy).reference_nm == 650.0


def test_an_unchanged_camera_gives_the_same_object_and_samples_no_curve(
    chromatic, aplanat_bpy, monkeypatch
):
    chromatic.axial_first, chromatic.use_equalizer = "CURVE", True
    set_points(chromatic.curves.nodes[EQUALIZER].mapping, [(0, 0.3, "AUTO"), (1, 0.8, "VECTOR")])
    first = read(aplanat_bpy)

    def fail(_mapping):
        raise AssertionError("sampled again")

    monkeypatch.setattr(drawn_curves, "_sampled", fail)
    aplanat_bpy.context.scene.frame_set(7)
    assert read(aplanat_bpy) is first


def test_keyframes_change_the_snapshot(chromatic, aplanat_bpy):
    for frame, strength, atom in ((1, 0.0, "IDENTITY"), (11, 5.0, "RECIPROCAL")):
        chromatic.axial, chromatic.lateral_then = strength, atom
        for name in ("axial", "lateral_then"):
            assert chromatic.id_data.keyframe_insert(f"aplanat.chromatic.{name}", frame=frame)
    assert at_frame(aplanat_bpy, 1).axial == 0.0
    assert 1.0 < at_frame(aplanat_bpy, 6).axial < 4.0
    last = at_frame(aplanat_bpy, 11)
    assert last.axial == 5.0 and last.lateral_map.g == "RECIPROCAL"


def test_a_driver_changes_the_snapshot(camera, chromatic, aplanat_bpy):
    camera.driver_add("aplanat.chromatic.lateral").driver.expression = "frame / 4"
    assert at_frame(aplanat_bpy, 8).lateral == pytest.approx(2.0 * LATERAL_UNIT)
    assert at_frame(aplanat_bpy, 20).lateral == pytest.approx(5.0 * LATERAL_UNIT)


def test_the_points_of_a_curve_are_animated_and_driven(chromatic, aplanat_bpy):
    chromatic.axial_first = "CURVE"
    group = chromatic.curves
    point = group.nodes["Axial First"].mapping.curves[0].points[1]
    for frame, value in ((1, 1.0), (11, -1.0)):
        point.location = 1.0, value
        assert group.keyframe_insert(CURVE_PATH, frame=frame)
    for frame, value in ((1, 1.0), (6, 0.0), (11, -1.0)):
        found = at_frame(aplanat_bpy, frame).axial_map(1.0)
        assert found == pytest.approx(value, abs=1e-6), frame
    driven = 'nodes["Lateral Then"].mapping.curves[0].points[0].location'
    chromatic.lateral_then = "CURVE"
    group.driver_add(driven, 1).driver.expression = "frame / 100"
    assert at_frame(aplanat_bpy, 50).lateral_map(0.0) == pytest.approx(0.5, abs=SINGLE)


def test_a_curve_that_is_drawn_restarts_the_picture_but_reads_no_geometry(
    chromatic, aplanat_bpy, empty_scene
):
    bpy = aplanat_bpy
    chromatic.axial_first = "CURVE"
    extractor = SceneExtractor()
    before = extractor.extract(bpy.context.evaluated_depsgraph_get())
    seen = []

    def note(_scene, depsgraph):
        seen.append(len(depsgraph.updates))
        extractor.note_updates(depsgraph)

    bpy.app.handlers.depsgraph_update_post.append(note)
    try:
        set_points(chromatic.curves.nodes["Axial First"].mapping, [(0, 1, "AUTO"), (1, 0, "AUTO")])
        bpy.context.view_layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(note)
    assert seen and not extractor._stale
    after = extractor.extract(bpy.context.evaluated_depsgraph_get())
    assert compare(before, after) == Change.CAMERA
    chromatic.axial_first = "IDENTITY"
    chromatic.axial_first = "CURVE"
    assert compare(after, extractor.extract(bpy.context.evaluated_depsgraph_get())) == Change.NONE


def test_a_drawn_curve_is_what_blenders_widget_shows(chromatic, aplanat_bpy):
    chromatic.axial_first = "CURVE"
    mapping = chromatic.curves.nodes["Axial First"].mapping
    set_points(mapping, [(0, 0.2, "AUTO"), (0.3, -0.6, "AUTO_CLAMPED"), (1, 0.9, "VECTOR")])
    values = curve_values(chromatic.curves, "Axial First")
    assert len(values) == SAMPLES
    mapping.initialize()
    for place in (0.0, 0.1, 0.3, 0.55, 1.0):
        shown = mapping.evaluate(mapping.curves[0], place)
        found = read(aplanat_bpy).axial_map(place)
        # Straight lines between 257 samples of a curve that bends with a radius above 0.05.
        assert found == pytest.approx(shown, abs=2e-3), place


def test_the_equalizer_lies_over_380_to_780_nm_whatever_range_is_drawn(chromatic, aplanat_bpy):
    chromatic.use_equalizer = True
    set_points(chromatic.curves.nodes[EQUALIZER].mapping, [(0, 0, "VECTOR"), (1, 1, "VECTOR")])
    chromatic.wavelength_min, chromatic.wavelength_max = 480.0, 680.0
    found = read(aplanat_bpy)
    assert found.wavelength_range == (480.0, 680.0) and 480.0 < found.reference_nm < 680.0
    assert found.equalizer(np.array([380.0, 480.0, 580.0, 780.0])) == pytest.approx(
        [0.0, 0.25, 0.5, 1.0], abs=1e-3
    )
    chromatic.mode = "RGB"
    assert read(aplanat_bpy).equalizer is FLAT


def test_the_real_lens_parts_the_colours_as_it_is_traced(camera, chromatic, aplanat_bpy):
    chromatic.dispersion = "LENS"
    camera.aplanat.lens = TESSAR
    whole = read_whole(aplanat_bpy)
    assert whole.report == ()
    configuration = whole.real_lens.prescription.configuration()
    assert whole.chromatic.dispersion == lens_dispersion(configuration)
    # Of a corrected lens a tenth of a glass': its colours come together.
    glass = np.ptp(glass_dispersion("N-BK7").ratio([450.0, 550.0, 650.0]))
    lens = np.ptp(whole.chromatic.dispersion.ratio([450.0, 550.0, 650.0]))
    assert 0.0 < lens < 0.5 * glass


def test_an_orthographic_camera_has_the_focal_length_of_its_aperture(camera, aplanat_bpy):
    camera.type = "ORTHO"
    assert read(aplanat_bpy).focal_length == 1.0


PROBLEMS = (
    ({"glass": "BK77"}, "the catalogue has no glass 'BK77'; near names are"),
    ({"glass": ""}, "the catalogue has no glass ''"),
    ({"dispersion": "LENS"}, "has no real lens whose colors could be used; those of N-BK7"),
    ({"wavelength_min": 700.0, "wavelength_max": 500.0}, "the wavelengths 700 to 500 nm do not"),
    ({"wavelength_min": 500.0, "wavelength_max": 500.0}, "380 to 780 nm are used"),
    ({"axial_then": "RECIPROCAL"}, "the axial map 1/t grows without bound; it is clamped to 100"),
    (
        {"lateral_first": "ONE_MINUS", "lateral_then": "RECIPROCAL"},
        "the lateral map 1/(1 \u2212 t) grows without bound",
    ),
)


@pytest.mark.parametrize(("settings", "problem"), PROBLEMS)
def test_what_cannot_be_done_is_told_and_something_is_drawn(
    camera, chromatic, aplanat_bpy, settings, problem
):
    for name, value in settings.items():
        setattr(chromatic, name, value)
    found = read_whole(aplanat_bpy)
    assert all(line.startswith("camera 'Camera': ") for line in found.report)
    assert problem in found.report[0] and len(found.report) <= 2
    assert found.chromatic is not None
    assert read_through_camera(aplanat_bpy).report == found.report
    assert found.chromatic.wavelength_range[0] < found.chromatic.wavelength_range[1]


def test_missing_curves_are_told(chromatic, aplanat_bpy):
    chromatic.axial_first, chromatic.use_equalizer = "CURVE", True
    aplanat_bpy.data.node_groups.remove(chromatic.curves)
    found = read_whole(aplanat_bpy)
    assert "the axial map has no drawn curve" in found.report[0]
    assert "the spectral equalizer has no curve" in found.report[1]
    assert found.chromatic.axial_map(0.25) == 0.25
    assert found.chromatic.equalizer is FLAT


def test_an_equalizer_that_leaves_nothing_is_told(chromatic, aplanat_bpy):
    chromatic.use_equalizer = True
    set_points(chromatic.curves.nodes[EQUALIZER].mapping, [(0, 0, "AUTO"), (1, 0, "AUTO")])
    found = read_whole(aplanat_bpy)
    assert "leaves no wavelength" in found.report[0]
    assert found.chromatic.equalizer is FLAT
