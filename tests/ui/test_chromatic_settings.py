"""Chromatic aberration of a camera as Blender keeps it: curves, what a lens remembers."""

import json

import pytest

from addon.sampling.equalizer import EQUALIZER_PRESETS
from addon.scene.camera.chromatic import read_field_map
from addon.scene.camera.drawn_curves import CURVE_NAMES, EQUALIZER, curve_points, curve_values
from addon.ui.operators import chromatic_curves, chromatic_operators
from addon.ui.properties.chromatic_properties import SETTING_NAMES
from addon.ui.properties.lens_memory import values_of

TESSAR, PLANAR = "tessar-50mm-f2.8", "planar-50mm-f1.4"
MENU = "APLANAT_PT_chromatic_presets"
# Float properties have 32 bits, and so have the points of curves.
SINGLE = 1e-6


@pytest.fixture
def chromatic(camera):
    return camera.aplanat.chromatic


def all_values(chromatic):
    return values_of(chromatic, SETTING_NAMES)


def mapping(chromatic, name):
    return chromatic.curves.nodes[name].mapping


def test_a_new_camera_is_achromatic_and_has_no_curves(chromatic, aplanat_bpy):
    assert not chromatic.use
    assert chromatic.curves is None
    assert not aplanat_bpy.data.node_groups


def test_strengths_may_be_negative(chromatic):
    chromatic.axial, chromatic.lateral = -2.5, -3.5
    assert (chromatic.axial, chromatic.lateral) == (-2.5, -3.5)


def test_choosing_a_drawn_curve_makes_one_that_changes_nothing(chromatic, aplanat_bpy):
    chromatic.axial_then = "CURVE"
    (group,) = aplanat_bpy.data.node_groups
    assert chromatic.curves == group
    # Hidden from Blender's menus.
    assert group.name.startswith(".")
    assert {node.name for node in group.nodes} == set(CURVE_NAMES)
    field_map = read_field_map(chromatic, "axial")
    assert field_map(0.3) == pytest.approx(0.3, abs=SINGLE)
    assert set(curve_values(group, EQUALIZER)) == {1.0}
    chromatic.lateral_first = "CURVE"
    chromatic.use_equalizer = True
    assert len(aplanat_bpy.data.node_groups) == 1


def test_a_curve_may_be_drawn_below_zero_but_not_that_of_the_equalizer(chromatic):
    chromatic.axial_first = "CURVE"
    assert mapping(chromatic, "Axial First").clip_min_y == -1.0
    assert mapping(chromatic, EQUALIZER).clip_min_y == 0.0


def test_a_copied_camera_gets_curves_of_its_own(camera, chromatic, aplanat_bpy):
    bpy = aplanat_bpy
    chromatic.axial_first = "CURVE"
    bpy.context.evaluated_depsgraph_get()
    copy = camera.copy()
    obj = bpy.data.objects.new("Copy", copy)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.update()
    own = copy.aplanat.chromatic.curves
    assert own != chromatic.curves and own.users == 1
    chromatic_curves.set_points(
        mapping(copy.aplanat.chromatic, "Axial First"), [(0, 1, "VECTOR"), (1, 0, "VECTOR")]
    )
    assert read_field_map(copy.aplanat.chromatic, "axial")(0.25) == pytest.approx(0.75, abs=SINGLE)
    assert read_field_map(chromatic, "axial")(0.25) == pytest.approx(0.25, abs=SINGLE)


def test_curves_are_saved_loaded_and_appended(camera, chromatic, aplanat_bpy, tmp_path):
    bpy = aplanat_bpy
    chromatic.use, chromatic.lateral_then = True, "CURVE"
    points = [(0.0, 1.0, "VECTOR"), (0.5, -0.5, "AUTO"), (1.0, 0.25, "AUTO_CLAMPED")]
    chromatic_curves.set_points(mapping(chromatic, "Lateral Then"), points)
    drawn = curve_values(chromatic.curves, "Lateral Then")
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    loaded = bpy.data.cameras["Camera"].aplanat.chromatic
    assert curve_points(mapping(loaded, "Lateral Then")) == tuple(points)
    assert curve_values(loaded.curves, "Lateral Then") == drawn
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for _ in range(2):
        with bpy.data.libraries.load(path) as (there, here):
            here.cameras = there.cameras[:1]
        appended = here.cameras[0].aplanat.chromatic
        assert curve_values(appended.curves, "Lateral Then") == drawn


def test_an_override_of_a_linked_camera_may_have_local_curves(
    camera, chromatic, aplanat_bpy, tmp_path
):
    bpy = aplanat_bpy
    chromatic.use, chromatic.axial_first = True, "CURVE"
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (there, here):
        here.objects, here.cameras = there.objects[:], there.cameras[:]
    linked = here.objects[0]
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.scene.camera = linked
    assert not bpy.ops.camera.aplanat_make_curves.poll()
    override = linked.data.override_create()
    with bpy.context.temp_override(camera=override):
        assert bpy.ops.camera.aplanat_make_curves() == {"FINISHED"}
    own = override.aplanat.chromatic
    assert own.curves.is_editable and own.curves != linked.data.aplanat.chromatic.curves
    own.axial = 3.0
    chromatic_curves.set_points(mapping(own, "Axial First"), [(0, 0, "AUTO"), (1, -1, "AUTO")])
    shot = str(tmp_path / "shot.blend")
    override.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=shot)
    bpy.ops.wm.open_mainfile(filepath=shot)
    kept = next(data for data in bpy.data.cameras if data.override_library).aplanat.chromatic
    assert kept.axial == 3.0
    assert read_field_map(kept, "axial")(1.0) == pytest.approx(-1.0, abs=SINGLE)


def test_curves_that_were_deleted_can_be_made_again(chromatic, aplanat_bpy):
    chromatic.axial_first = "CURVE"
    aplanat_bpy.data.node_groups.remove(chromatic.curves)
    assert read_field_map(chromatic, "axial")(0.5) == 0.5
    assert aplanat_bpy.ops.camera.aplanat_make_curves() == {"FINISHED"}
    assert curve_values(chromatic.curves, "Axial First") is not None
    chromatic.curves.nodes.remove(chromatic.curves.nodes[EQUALIZER])
    assert aplanat_bpy.ops.camera.aplanat_make_curves() == {"FINISHED"}
    assert curve_values(chromatic.curves, EQUALIZER) is not None


def test_curves_go_through_text_and_nonsense_is_left_out(chromatic):
    chromatic.use_equalizer = True
    points = [(0.0, 0.5, "VECTOR"), (0.25, 1.0, "VECTOR"), (1.0, 0.0, "AUTO")]
    chromatic_curves.set_points(mapping(chromatic, EQUALIZER), points)
    text = chromatic.curve_text
    chromatic_curves.set_points(mapping(chromatic, EQUALIZER), points[1:])
    chromatic.curve_text = text
    assert curve_points(mapping(chromatic, EQUALIZER)) == tuple(points)
    for nonsense in (
        "",
        "{",
        "[1]",
        '{"Equalizer": 3}',
        json.dumps({EQUALIZER: [[0, 0, "AUTO"]]}),
        json.dumps({EQUALIZER: [[0, 0, "AUTO"], [1, "x", "AUTO"]]}),
        json.dumps({EQUALIZER: [[1, 0, "AUTO"], [0, 1, "AUTO"]]}),
        json.dumps({EQUALIZER: [[0, 0, "AUTO"], [1, float("nan"), "AUTO"]]}),
        json.dumps({EQUALIZER: [[0, 0, "NONE"], [1, 1, "AUTO"]]}),
    ):
        chromatic.curve_text = nonsense
        assert chromatic.curve_text == text, nonsense


@pytest.mark.parametrize("name", EQUALIZER_PRESETS)
def test_an_equalizer_preset_draws_its_curve(chromatic, aplanat_bpy, name):
    chromatic.mode = "RGB"
    assert aplanat_bpy.ops.camera.aplanat_equalizer_preset(preset=name) == {"FINISHED"}
    assert chromatic.use_equalizer and chromatic.mode == "SPECTRAL"
    _, wanted = EQUALIZER_PRESETS[name]
    points = curve_points(mapping(chromatic, EQUALIZER))
    assert [380.0 + 400.0 * x for x, _, _ in points] == pytest.approx(wanted.wavelengths_nm)
    drawn = curve_values(chromatic.curves, EQUALIZER)
    # At samples that are points: Blender interpolates its own table in between.
    for x, weight, _ in points:
        sample = x * (len(drawn) - 1)
        if abs(sample - round(sample)) < 1e-4:
            assert drawn[round(sample)] == pytest.approx(weight, abs=1e-3)


def test_an_own_preset_keeps_everything_and_its_curves(chromatic, aplanat_bpy, preset_folder):
    bpy = aplanat_bpy
    chromatic.use, chromatic.axial, chromatic.glass = True, -1.5, "F2"
    chromatic.lateral_then = "CURVE"
    chromatic_curves.set_points(
        mapping(chromatic, "Lateral Then"), [(0, 0.5, "VECTOR"), (1, -0.5, "VECTOR")]
    )
    before = all_values(chromatic)
    assert bpy.ops.camera.aplanat_chromatic_preset_add(name="Mine") == {"FINISHED"}
    saved = next(preset_folder.rglob("Mine.py"))
    other = bpy.data.cameras.new("Other")
    with bpy.context.temp_override(camera=other):
        bpy.ops.script.execute_preset(filepath=str(saved), menu_idname=MENU)
    assert all_values(other.aplanat.chromatic) == before
    assert other.aplanat.chromatic.curves != chromatic.curves


def test_a_lens_remembers_drawn_curves_too(camera, chromatic):
    chromatic.use, chromatic.axial = True, 2.0
    camera.aplanat.lens = TESSAR
    # A new lens takes over what is there.
    assert chromatic.use and chromatic.axial == 2.0
    chromatic.axial, chromatic.glass, chromatic.mode = 4.0, "F2", "RGB"
    chromatic.lateral_first = "CURVE"
    chromatic_curves.set_points(
        mapping(chromatic, "Lateral First"), [(0, 1, "AUTO"), (1, 0, "AUTO")]
    )
    of_tessar = all_values(chromatic)
    camera.aplanat.lens = PLANAR
    chromatic.use, chromatic.axial, chromatic.glass = False, 0.5, "N-SF11"
    chromatic_curves.set_points(
        mapping(chromatic, "Lateral First"), [(0, 0, "AUTO"), (1, 1, "AUTO")]
    )
    of_planar = all_values(chromatic)
    camera.aplanat.lens = TESSAR
    assert all_values(chromatic) == of_tessar
    camera.aplanat.lens_choice = f"lens:{PLANAR}"
    assert all_values(chromatic) == of_planar
    camera.aplanat.lens = ""
    assert chromatic.use and chromatic.axial == 2.0
    camera.aplanat.lens = TESSAR
    camera.aplanat.lens = TESSAR
    assert all_values(chromatic) == of_tessar


def test_operators_can_be_undone_and_explain_themselves():
    for operator in (
        chromatic_operators.APLANAT_OT_make_curves,
        chromatic_operators.APLANAT_OT_equalizer_preset,
    ):
        assert "UNDO" in operator.bl_options
        assert operator.bl_description and not operator.bl_description.endswith(".")
