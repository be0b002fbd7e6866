"""The lens of a camera as Blender keeps it, and the operators on it and on the library."""

import math

import pytest

from addon.engine.shared_resources import real_lens_of, resources
from addon.lens_io.lens_shelf import LensShelf
from addon.lens_io.library import SHIPPED_FOLDER
from addon.ui.operators import lens_import, lens_operators
from addon.ui.properties import camera_properties

TESSAR, ZOOM = "tessar-50mm-f2.8", "zoom-36-69mm-f3.5"
CHANGING = (
    lens_operators.APLANAT_OT_choose_lens,
    lens_operators.APLANAT_OT_use_focal_length,
    lens_operators.APLANAT_OT_match_zoom,
    lens_operators.APLANAT_OT_use_iris,
    lens_operators.APLANAT_OT_edit_lens,
    lens_import.APLANAT_OT_import_lens,
)


@pytest.fixture
def own_folder(tmp_path, monkeypatch, aplanat_bpy):
    """A folder of the user's, in place of the real one."""
    folder = tmp_path / "lenses"
    monkeypatch.setattr(resources(), "lenses", LensShelf([folder]))
    for module in (lens_operators, lens_import):
        monkeypatch.setattr(module, "user_folder", lambda: folder)
    return folder


@pytest.fixture
def camera(camera, own_folder):
    return camera


def test_a_new_camera_has_a_thin_lens(camera):
    assert camera.aplanat.lens == ""
    assert camera.aplanat.lens_choice == "thin"


def test_the_chooser_and_the_name_are_the_same_setting(camera):
    camera.aplanat.lens_choice = f"lens:{TESSAR}"
    assert camera.aplanat.lens == TESSAR
    camera.aplanat.lens = ZOOM
    assert camera.aplanat.lens_choice == f"lens:{ZOOM}"
    camera.aplanat.lens_choice = "thin"
    assert camera.aplanat.lens == ""


def test_an_unknown_lens_is_shown_and_kept(camera):
    camera.aplanat.lens = "from-elsewhere"
    assert camera.aplanat.lens_choice == "lens:from-elsewhere"
    assert camera.aplanat.lens == "from-elsewhere"


def test_zoom_positions_are_chosen_by_name(camera):
    camera.aplanat.lens = ZOOM
    assert camera.aplanat.zoom == "36 mm"
    camera.aplanat.zoom = "69 mm"
    assert camera.aplanat.zoom_label == "69 mm"
    camera.aplanat.lens = TESSAR
    # A lens without positions says nothing about them.
    assert camera.aplanat.zoom_label == "69 mm"
    camera.aplanat.lens = "zoom-24-105mm-f4"
    assert camera.aplanat.zoom_label == ""


def test_search_finds_by_id_and_by_name(camera):
    def found(typed):
        return [
            lens_id for lens_id, _ in camera_properties._found_lenses(camera.aplanat, None, typed)
        ]

    assert TESSAR in found("")
    assert found("tess") == [TESSAR]
    assert found("TESSAR TYPE") == [TESSAR]
    assert found("no such lens") == []


def test_the_lens_is_saved_copied_and_appended(camera, aplanat_bpy, tmp_path):
    bpy = aplanat_bpy
    camera.aplanat.lens, camera.aplanat.zoom_label = ZOOM, "50 mm"
    assert camera.copy().aplanat.lens == ZOOM
    path = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    loaded = bpy.data.cameras["Camera"].aplanat
    assert (loaded.lens, loaded.zoom_label) == (ZOOM, "50 mm")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path) as (there, here):
        here.cameras = there.cameras[:1]
    assert here.cameras[0].aplanat.lens == ZOOM


def test_a_linked_camera_is_left_alone_and_an_override_may_change(
    camera, aplanat_bpy, tmp_path, empty_scene
):
    bpy = aplanat_bpy
    camera.aplanat.lens = ZOOM
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (there, here):
        here.objects, here.cameras = there.objects[:], there.cameras[:]
    linked = here.objects[0]
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.scene.camera = linked
    assert linked.data.aplanat.lens == ZOOM
    assert not bpy.ops.camera.aplanat_use_focal_length.poll()
    override = linked.data.override_create()
    assert override.override_library and override.aplanat.lens == ZOOM
    override.aplanat.lens, override.use_fake_user = TESSAR, True
    path = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    kept = next(data for data in bpy.data.cameras if data.override_library)
    assert kept.aplanat.lens == TESSAR


def test_the_focal_length_is_applied_on_demand_only(camera, aplanat_bpy):
    operator = aplanat_bpy.ops.camera.aplanat_use_focal_length
    assert not operator.poll()
    camera.lens = 35.0
    camera.aplanat.lens = "double-gauss-50mm-f2"
    assert camera.lens == 35.0
    assert operator() == {"FINISHED"}
    # The computed focal length, not the nominal 50 mm.
    assert camera.lens == pytest.approx(50.36, abs=0.01)


def test_zoom_is_matched_to_the_camera(camera, aplanat_bpy):
    camera.aplanat.lens = ZOOM
    for focal_length, label in ((20.0, "36 mm"), (48.0, "50 mm"), (300.0, "69 mm")):
        camera.lens = focal_length
        assert aplanat_bpy.ops.camera.aplanat_match_zoom() == {"FINISHED"}
        assert camera.aplanat.zoom_label == label
        assert camera.lens == focal_length
    camera.aplanat.lens = TESSAR
    assert not aplanat_bpy.ops.camera.aplanat_match_zoom.poll()


def test_the_iris_of_the_lens_is_taken_over(camera, aplanat_bpy, own_folder):
    own_folder.mkdir()
    text = (SHIPPED_FOLDER / f"{TESSAR}.toml").read_text(encoding="utf-8")
    head, _, tail = text.partition("[diaphragm]")
    tail = tail[tail.index("[[surface]]") :]
    own = own_folder / "many.toml"
    own.write_text(
        f"{head}[diaphragm]\nblades = 20\nblade_curvature = 0.4\nrotation_deg = 270.0\n\n{tail}",
        "utf-8",
    )
    resources().lenses.reload()
    camera.aplanat.lens = "many"
    assert aplanat_bpy.ops.camera.aplanat_use_iris() == {"FINISHED"}
    assert camera.dof.aperture_blades == 16
    assert camera.dof.aperture_rotation == pytest.approx(-math.pi / 2)
    assert camera.aplanat.bokeh.blade_curvature == pytest.approx(0.4)


def test_the_iris_of_an_anamorphic_lens_has_its_squeeze(camera, aplanat_bpy):
    camera.aplanat.lens = "anamorphic-60mm-f2"
    assert aplanat_bpy.ops.camera.aplanat_use_iris() == {"FINISHED"}
    assert camera.dof.aperture_ratio == pytest.approx(60.555 / 31.5, rel=0.01)
    camera.aplanat.lens = TESSAR
    assert aplanat_bpy.ops.camera.aplanat_use_iris() == {"FINISHED"}
    assert camera.dof.aperture_ratio == 1.0


def test_a_lens_file_is_imported_and_used(camera, aplanat_bpy, own_folder, shared):
    samples = shared / "lenses" / "import-samples"
    run = aplanat_bpy.ops.camera.aplanat_import_lens
    assert run(filepath=str(samples / "aspheric-30mm-f2.zmx")) == {"FINISHED"}
    assert (own_folder / f"{camera.aplanat.lens}.toml").is_file()
    used = camera.aplanat.lens
    assert run(filepath=str(SHIPPED_FOLDER / f"{TESSAR}.toml"), use_for_camera=False) == {
        "FINISHED"
    }
    assert camera.aplanat.lens == used
    assert f"{TESSAR}-2" in resources().lenses.ids()


def test_an_import_that_is_refused_says_what_to_choose(camera, aplanat_bpy, own_folder, shared):
    samples = shared / "lenses" / "import-samples"
    run = aplanat_bpy.ops.camera.aplanat_import_lens
    with pytest.raises(RuntimeError, match="I02"):
        run(filepath=str(samples / "reject-mirror.zmx"))
    with pytest.raises(RuntimeError, match="choose with Surfaces in the options") as raised:
        run(filepath=str(samples / "cooke-triplet-no-rdm.seq"))
    assert len(str(raised.value).strip().splitlines()) == 1
    assert "--" not in str(raised.value)
    with pytest.raises(RuntimeError, match="glass 'BK7' must be NAME=ND,VD"):
        run(filepath=str(samples / "cooke-triplet-no-rdm.seq"), glasses="BK7")
    assert not own_folder.exists() and camera.aplanat.lens == ""
    done = run(filepath=str(samples / "cooke-triplet-no-rdm.seq"), radii="RADIUS", half_field=0.35)
    assert done == {"FINISHED"}


def test_a_shipped_lens_is_copied_to_be_edited(camera, aplanat_bpy, own_folder):
    bpy = aplanat_bpy
    camera.aplanat.lens = TESSAR
    assert bpy.ops.camera.aplanat_edit_lens() == {"FINISHED"}
    assert camera.aplanat.lens == f"{TESSAR}-copy"
    own = own_folder / f"{TESSAR}-copy.toml"
    assert [text.filepath for text in bpy.data.texts] == [str(own)]
    assert "(copy)" in bpy.data.texts[0].as_string()
    # One's own lens is opened as it is, once.
    assert bpy.ops.camera.aplanat_edit_lens() == {"FINISHED"}
    assert len(bpy.data.texts) == 1 and camera.aplanat.lens == f"{TESSAR}-copy"


def test_an_edited_lens_is_read_again_on_reload(camera, aplanat_bpy, own_folder):
    bpy = aplanat_bpy
    camera.aplanat.lens = TESSAR
    bpy.ops.camera.aplanat_edit_lens()
    own = own_folder / f"{TESSAR}-copy.toml"
    own.write_text(own.read_text("utf-8").replace("f_number = 2.8", "f_number = 2.9"), "utf-8")
    assert real_lens_of(camera).prescription.f_number == 2.8
    assert bpy.ops.wm.aplanat_reload_lenses() == {"FINISHED"}
    assert real_lens_of(camera).prescription.f_number == 2.9


def test_only_lenses_of_ones_own_are_removed(camera, aplanat_bpy, own_folder):
    bpy = aplanat_bpy
    camera.aplanat.lens = TESSAR
    assert not bpy.ops.camera.aplanat_remove_lens.poll()
    bpy.ops.camera.aplanat_edit_lens()
    assert bpy.ops.camera.aplanat_remove_lens() == {"FINISHED"}
    assert not list(own_folder.iterdir())
    # The name stays, so that the lens can come back.
    assert camera.aplanat.lens == f"{TESSAR}-copy"
    assert real_lens_of(camera) is None


def test_operators_can_be_undone_and_explain_themselves():
    for operator in CHANGING:
        assert "UNDO" in operator.bl_options, operator
    for operator in (*lens_operators.CLASSES, *lens_import.CLASSES):
        assert operator.bl_description and not operator.bl_description.endswith(".")
        for prop in operator.bl_rna.properties:
            if prop.identifier != "rna_type" and not prop.is_hidden:
                assert prop.name, f"{operator.bl_idname}.{prop.identifier}"


def test_nothing_is_made_in_the_background_of_a_blender_without_windows(camera):
    from addon.ui.jobs import background

    camera.aplanat.lens_choice = f"lens:{TESSAR}"
    assert background.progress() is None


@pytest.mark.parametrize(
    ("typed", "found"),
    [
        ("50mm f/1.4", "planar-50mm-f1.4"),
        ("1975 gauss", "planar-50mm-f1.4"),
        ("fisheye", "fisheye-16mm-f2.8"),
        ("ZOOM 24-105", "zoom-24-105mm-f4"),
        ("glatzel", "planar-50mm-f1.4"),
    ],
)
def test_a_lens_is_found_by_its_figures_kind_and_year(camera, typed, found):
    from addon.ui.properties.camera_properties import _found_lenses

    listed = dict(_found_lenses(camera.aplanat, None, typed))
    assert found in listed and len(listed) < 12
    assert "mm" in listed[found] and "f/" in listed[found]
    assert not dict(_found_lenses(camera.aplanat, None, f"{typed} nonsense"))
