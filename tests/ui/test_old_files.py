"""Files of older versions open with every setting kept, and opening them changes nothing.

`saved_by_0_1` holds files that Aplanat 0.1 saved, and what it read of them itself.
"""

import json
import shutil
from pathlib import Path

import pytest

from addon.ui.properties import migrations
from addon.ui.properties.migrations import VERSION, stored_settings

from .saved_by_0_1.make import all_values, values_of

FOLDER = Path(__file__).parent / "saved_by_0_1"
SAVED = json.loads((FOLDER / "settings.json").read_text(encoding="utf-8"))


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
            if prop.type == "ENUM":
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


def test_opening_changes_nothing(aplanat_bpy, opened):
    assert not aplanat_bpy.data.is_dirty
    for scene in aplanat_bpy.data.scenes:
        assert "settings_version" not in stored_settings(scene)
    changed = aplanat_bpy.data.cameras["overridden"].override_library
    assert {prop.rna_path for prop in changed.properties} == {
        "aplanat.bokeh.model",
        "aplanat.chromatic.lateral",
    }


def test_saving_and_opening_again_keeps_every_setting(aplanat_bpy, opened):
    aplanat_bpy.ops.wm.save_mainfile()
    aplanat_bpy.ops.wm.open_mainfile(filepath=opened)
    assert kept() == SAVED
    for scene in aplanat_bpy.data.scenes:
        assert stored_settings(scene)["settings_version"] == VERSION


def test_a_scene_of_another_engine_gets_no_settings(aplanat_bpy, empty_scene, tmp_path):
    empty_scene.render.engine = "BLENDER_WORKBENCH"
    assert stored_settings(empty_scene) is None
    aplanat_bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    assert stored_settings(empty_scene) is None


def test_a_step_runs_once_and_reads_what_has_no_property_any_more(aplanat_bpy, opened, monkeypatch):
    bpy = aplanat_bpy
    seen = []

    def rename(kind, stored):
        seen.append(kind)
        if kind == "cameras" and "gone" in stored["bokeh"]:
            stored["bokeh"]["gain"] = 10.0 * stored["bokeh"]["gone"]
            del stored["bokeh"]["gone"]

    stored_settings(bpy.data.cameras["camera 2"])["bokeh"]["gone"] = 0.3
    bpy.ops.wm.save_mainfile()
    before = values_of(bpy.data.cameras["camera 1"])
    monkeypatch.setattr(migrations, "STEPS", {VERSION + 1: rename})
    monkeypatch.setattr(migrations, "VERSION", VERSION + 1)
    bpy.ops.wm.open_mainfile(filepath=opened)
    assert set(seen) == {"scenes", "cameras", "lights", "materials", "worlds", "view_layers"}
    assert bpy.data.cameras["camera 2"].aplanat.bokeh.gain == pytest.approx(3.0)
    assert values_of(bpy.data.cameras["camera 1"]) == before
    seen.clear()
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=opened)
    assert not seen
    assert bpy.data.cameras["camera 2"].aplanat.bokeh.gain == pytest.approx(3.0)
