"""Files of older versions open with every setting kept, and opening them changes nothing.

`saved_by_0_1` holds files that Aplanat 0.1 saved, and what it read of them itself.
"""

import json
import shutil
from pathlib import Path

import pytest

from addon.ui.properties import migrations
from addon.ui.properties.migrations import VERSION, stored_settings
from addon.ui.properties.moved_settings import move, move_animation

from .saved_by_0_1.make import all_values, values_of

FOLDER = Path(__file__).parent / "saved_by_0_1"


def saved():
    """Return the settings that 0.1 read, by the paths that they have now."""
    found = json.loads((FOLDER / "settings.json").read_text(encoding="utf-8"))
    for settings in found["cameras"].values():
        # There was none without bokeh.
        source = settings.pop("bokeh.distortion_source")
        settings["distortion"] = source if settings["bokeh.use"] else "NONE"
        settings["distortion_k"] = settings.pop("bokeh.distortion")
    return found


SAVED = saved()


# Choices that 0.1 did not have.
LATER = {"LAYERED"}


@pytest.fixture
def opened(aplanat_bpy, tmp_path):
    """Open a copy of the file of 0.1; return its path."""
    for name in ("settings.blend", "library.blend"):
        shutil.copy(FOLDER / name, tmp_path / name)
    path = str(tmp_path / "settings.blend")
    aplanat_bpy.ops.wm.open_mainfile(filepath=path)
    yield path
    aplanat_bpy.ops.wm.read_factory_settings(use_empty=True)


def kept():
    """Return the settings that 0.1 had, as they are now."""
    found = all_values()
    return {
        kind: {
            name: {path: found[kind][name][path] for path in settings}
            for name, settings in blocks.items()
        }
        for kind, blocks in SAVED.items()
    }


def test_every_setting_of_0_1_is_kept(opened):
    found = kept()
    for kind, blocks in SAVED.items():
        assert found[kind] == blocks, kind


def test_the_file_has_every_choice_but_defaults(aplanat_bpy, opened):
    owners = {"scenes": "scene 0", "cameras": "camera 0", "lights": "light 0"}
    for kind, name in (*owners.items(), ("materials", "material 0")):
        group = getattr(aplanat_bpy.data, kind)[name].aplanat
        for path in SAVED[kind][name]:
            owner = group.path_resolve(path.rpartition(".")[0]) if "." in path else group
            prop = owner.bl_rna.properties[path.rpartition(".")[2]]
            if prop.type == "ENUM" and path != "distortion":
                used = {settings[path] for settings in SAVED[kind].values()} | {prop.default}
                assert used == set(prop.enum_items.keys()) - LATER, path


def test_keys_of_choices_are_kept(aplanat_bpy, opened):
    scene, camera = aplanat_bpy.context.scene, aplanat_bpy.data.cameras["camera 0"]
    found = []
    for frame in (1, 2):
        scene.frame_set(frame)
        found.append((camera.aplanat.bokeh.model, camera.aplanat.bokeh.threshold))
    assert found == [("POINT", 2.0), ("CLUSTERED", 4.0)]


def test_what_a_lens_remembers_is_kept(aplanat_bpy, opened):
    settings = aplanat_bpy.data.cameras["camera 0"].aplanat
    settings.lens = "tessar-50mm-f2.8"
    assert (settings.bokeh.onion, settings.chromatic.axial) == (0.5, 2.5)
    settings.lens = "planar-50mm-f1.4"
    assert (settings.bokeh.onion, settings.chromatic.axial) == (0.25, 3.5)


def test_opening_changes_nothing_but_what_moved(aplanat_bpy, opened):
    assert not aplanat_bpy.data.is_dirty
    for camera in aplanat_bpy.data.cameras:
        assert "distortion_source" not in stored_settings(camera)["bokeh"]
    changed = aplanat_bpy.data.cameras["overridden"].override_library
    assert {prop.rna_path for prop in changed.properties} == {
        "aplanat.bokeh.model",
        "aplanat.chromatic.lateral",
    }


def test_saving_and_opening_again_keeps_every_setting(aplanat_bpy, opened):
    aplanat_bpy.ops.wm.save_mainfile()
    aplanat_bpy.ops.wm.open_mainfile(filepath=opened)
    assert kept() == SAVED
    cameras = [c for c in aplanat_bpy.data.cameras if not c.library and not c.override_library]
    own = [stored_settings(camera) for camera in cameras]
    own += [stored_settings(scene.view_layers[0]) for scene in aplanat_bpy.data.scenes]
    assert {stored["settings_version"] for stored in own} == {VERSION}


def test_a_scene_of_another_engine_gets_no_settings(aplanat_bpy, empty_scene, tmp_path):
    empty_scene.render.engine = "BLENDER_WORKBENCH"
    assert stored_settings(empty_scene) is None
    aplanat_bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    assert stored_settings(empty_scene) is None


@pytest.fixture
def later(monkeypatch):
    """A later Aplanat: `bokeh.gone` became a tenth of `bokeh.gain`. Whom its step saw."""
    seen = []

    def rename(kind, _block, stored):
        bokeh = stored.get("bokeh", {})
        seen.append((kind, "gone" in bokeh))
        if "gone" in bokeh:
            bokeh["gain"] = 10.0 * bokeh["gone"]
            del bokeh["gone"]

    def install():
        monkeypatch.setattr(migrations, "STEPS", {VERSION + 1: rename})
        monkeypatch.setattr(migrations, "VERSION", VERSION + 1)
        return seen

    return install


@pytest.fixture
def old_library(aplanat_bpy, tmp_path):
    """Save the library of 0.1 with `bokeh.gone` in its camera; return its path."""
    path = str(tmp_path / "old.blend")
    aplanat_bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "library.blend"))
    stored_settings(aplanat_bpy.data.cameras["linked"])["bokeh"]["gone"] = 0.3
    aplanat_bpy.ops.wm.save_as_mainfile(filepath=path)
    aplanat_bpy.ops.wm.read_factory_settings(use_empty=True)
    yield path
    aplanat_bpy.ops.wm.read_factory_settings(use_empty=True)


def bring_in(bpy, path, link):
    """Link or append the camera of a library; return it."""
    with bpy.data.libraries.load(path, link=link) as (_, to):
        to.cameras = ["linked"]
    return to.cameras[0]


def test_a_step_runs_once_and_reads_what_has_no_property_any_more(aplanat_bpy, opened, later):
    bpy = aplanat_bpy
    stored_settings(bpy.data.cameras["camera 2"])["bokeh"]["gone"] = 0.3
    bpy.ops.wm.save_mainfile()
    before = values_of(bpy.data.cameras["camera 1"])
    seen = later()
    bpy.ops.wm.open_mainfile(filepath=opened)
    kinds = {"scenes", "cameras", "lights", "materials", "worlds", "view_layers"}
    assert {kind for kind, _ in seen} == kinds
    assert bpy.data.cameras["camera 2"].aplanat.bokeh.gain == pytest.approx(3.0)
    assert values_of(bpy.data.cameras["camera 1"]) == before
    bpy.ops.wm.save_mainfile()
    seen.clear()
    bpy.ops.wm.open_mainfile(filepath=opened)
    # The library is as old as before.
    assert {kind for kind, _ in seen} == {"cameras"}
    assert not any(had_it for _, had_it in seen)
    assert bpy.data.cameras["camera 2"].aplanat.bokeh.gain == pytest.approx(3.0)


@pytest.mark.parametrize("link", [True, False], ids=["linked", "appended"])
def test_a_step_runs_on_what_comes_from_an_older_file(aplanat_bpy, old_library, later, link):
    own = aplanat_bpy.data.cameras.new("own")
    own.aplanat.bokeh.gain = 2.0
    seen = later()
    camera = bring_in(aplanat_bpy, old_library, link)
    assert seen == [("cameras", True)]
    assert camera.aplanat.bokeh.gain == pytest.approx(3.0)
    assert own.aplanat.bokeh.gain == 2.0
    bring_in(aplanat_bpy, old_library, link=True)
    assert camera.aplanat.bokeh.gain == pytest.approx(3.0)


def test_a_step_runs_on_an_older_library_of_a_newer_file(aplanat_bpy, old_library, later, tmp_path):
    bpy = aplanat_bpy
    path = str(tmp_path / "new.blend")
    seen = later()
    for name, link in (("holder", True), ("other", False)):
        holder = bpy.data.objects.new(name, bring_in(bpy, old_library, link))
        bpy.context.scene.collection.objects.link(holder)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    seen.clear()
    bpy.ops.wm.open_mainfile(filepath=path)
    assert seen == [("cameras", True)], "the linked camera, not the appended one"
    assert bpy.data.objects["holder"].data.aplanat.bokeh.gain == pytest.approx(3.0)
    seen.clear()
    bpy.data.libraries[0].reload()
    assert seen == [("cameras", True)]
    assert bpy.data.objects["holder"].data.aplanat.bokeh.gain == pytest.approx(3.0)


def test_what_an_override_changes_is_kept_with_an_older_library(
    aplanat_bpy, old_library, later, tmp_path
):
    bpy = aplanat_bpy
    path = str(tmp_path / "new.blend")
    later()
    changed = bring_in(bpy, old_library, link=True).override_create()
    changed.use_fake_user = True
    changed.aplanat.bokeh.threshold = 7.0
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bokeh = next(c for c in bpy.data.cameras if c.override_library).aplanat.bokeh
    assert (bokeh.gain, bokeh.threshold) == (pytest.approx(3.0), 7.0)


def test_a_setting_moves_with_its_keys_and_drivers(aplanat_bpy, empty_scene):
    camera = aplanat_bpy.data.cameras.new("animated")
    empty_scene.collection.objects.link(aplanat_bpy.data.objects.new("animated", camera))
    settings = camera.aplanat
    settings.bokeh.threshold = 3.0
    for frame, value in ((1, 2.0), (3, 4.0)):
        settings.bokeh.onion = value / 10.0
        settings.bokeh.keyframe_insert("onion", frame=frame)
    settings.bokeh.driver_add("threshold").driver.expression = "7.0"
    stored = stored_settings(camera)
    for old, new in (("bokeh.onion", "chromatic.axial"), ("bokeh.threshold", "bokeh.gain")):
        assert move(stored, old, new)
        move_animation(camera, old, new)
    assert not move(stored, "bokeh.onion", "chromatic.axial"), "there is none any more"
    stored["bokeh"]["threshold"] = 1.0
    assert not move(stored, "bokeh.threshold", "bokeh.gain"), "the newer value stays"
    empty_scene.frame_set(3)
    assert (settings.chromatic.axial, settings.bokeh.gain) == (pytest.approx(0.4), 7.0)
    empty_scene.frame_set(1)
    assert settings.chromatic.axial == pytest.approx(0.2)


@pytest.mark.parametrize("link", [True, False], ids=["linked", "appended"])
def test_distortion_of_an_older_file_belongs_to_the_lens(aplanat_bpy, tmp_path, link):
    bpy = aplanat_bpy
    path = str(tmp_path / "old.blend")
    camera = bpy.data.cameras.new("linked")
    camera.use_fake_user = True
    camera.aplanat.bokeh.distortion_source = "DIVISION"
    for frame, k in ((1, -0.2), (10, 0.1)):
        camera.aplanat.distortion_k = k
        camera.keyframe_insert("aplanat.distortion_k", frame=frame)
    action, slot = camera.animation_data.action, camera.animation_data.action_slot
    (curve,) = action.layers[0].strips[0].channelbag(slot).fcurves
    curve.data_path = "aplanat.bokeh.distortion"
    stored = stored_settings(camera)
    bpy.ops.wm.save_as_mainfile(filepath=path)
    # Saving stamps it: an older Aplanat had not.
    stored["settings_version"] = 1
    bpy.data.libraries.write(path, {camera})
    bpy.ops.wm.read_factory_settings(use_empty=True)
    camera = bring_in(bpy, path, link)
    holder = bpy.data.objects.new("holder", camera)
    bpy.context.scene.collection.objects.link(holder)
    assert camera.aplanat.distortion == "DIVISION"
    for frame, k in ((1, -0.2), (10, 0.1)):
        bpy.context.scene.frame_set(frame)
        seen = holder.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        assert seen.aplanat.distortion_k == pytest.approx(k)
    bpy.ops.wm.read_factory_settings(use_empty=True)
