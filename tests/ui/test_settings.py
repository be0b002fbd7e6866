"""All that knows of a setting agrees: declaration, property, panel, reader, statistics, page."""

import dataclasses
import importlib.util
import re
from pathlib import Path

import pytest

from addon.cli.render.statistics import settings_in_force
from addon.engine.shared_resources import resources
from addon.lens_io.glasses.dispersion import DEFAULT_GLASS
from addon.registration import _MODULES
from addon.scene.camera.bokeh import describe_bokeh
from addon.scene.settings import read_preview_sampling, read_sampling
from addon.settings.bokeh_settings import BOKEH
from addon.settings.chromatic_settings import CHROMATIC
from addon.settings.refocus_settings import DEPTH_PASS, REFOCUS
from addon.settings.scene_part_settings import ABERRATIONS, DISTORTION, LAMP, LENS, MATERIAL, WORLD
from addon.settings.scene_settings import CAPTURE, MEASURING, PREVIEW, SCENE, VIEW_LAYER
from addon.settings.setting import settings_of
from addon.snapshot.camera import BokehSettings
from addon.snapshot.film import Sampling

from .panel_drawing import draw, panels_of, states

REPOSITORY = Path(__file__).resolve().parents[2]
# By the name of the property group.
GROUPS = {
    "AplanatSceneSettings": SCENE,
    "AplanatCaptureSettings": (CAPTURE,),
    "AplanatRefocusSettings": (REFOCUS, DEPTH_PASS),
    "AplanatViewLayerSettings": VIEW_LAYER,
    "AplanatCameraSettings": (LENS, ABERRATIONS, DISTORTION),
    "AplanatBokehSettings": BOKEH,
    "AplanatChromaticSettings": CHROMATIC,
    "AplanatMaterialSettings": (MATERIAL,),
    "AplanatLightSettings": (LAMP,),
    "AplanatWorldSettings": (WORLD,),
}
ALL = [
    (group, setting)
    for group, sections in GROUPS.items()
    for setting in settings_of(*sections).values()
]
IDS = [f"{group}.{setting.name}" for group, setting in ALL]
# Shown, but stored elsewhere, or stored, but no setting.
UNDECLARED = {
    "AplanatSceneSettings": {"capture", "refocus"},
    "AplanatCameraSettings": {
        *("lens_choice", "compared_lens", "zoom", "bokeh", "chromatic"),
        *("bokeh_lens", "bokeh_memory", "chromatic_lens", "chromatic_memory"),
    },
    "AplanatBokehSettings": {"distortion_source", "distortion"},
    "AplanatChromaticSettings": {"curves", "spectrum", "curve_text"},
}
# A menu with pictures stands for the first, a menu of the lens' positions for the second.
SHOWN_AS = {"zoom_label": "zoom"}
# Blender has no overrides of scenes.
NOT_OVERRIDABLE = {
    *("AplanatSceneSettings", "AplanatCaptureSettings", "AplanatRefocusSettings"),
    "AplanatViewLayerSettings",
}
KINDS = {bool: "BOOLEAN", int: "INT", float: "FLOAT", str: "STRING", type(None): "POINTER"}


def group_type(bpy, name):
    """Return a property group's description in Blender."""
    owners = (
        *(bpy.types.Scene, bpy.types.ViewLayer, bpy.types.Camera),
        *(bpy.types.Material, bpy.types.Light, bpy.types.World),
    )
    for owner in owners:
        found = owner.bl_rna.properties["aplanat"].fixed_type
        if found.identifier == name:
            return found.bl_rna
        for inner in found.properties:
            if inner.type == "POINTER" and inner.fixed_type.identifier == name:
                return inner.fixed_type.bl_rna
    raise AssertionError(name)


@pytest.mark.parametrize("name", GROUPS)
def test_a_group_has_the_declared_settings_and_no_others(aplanat_bpy, name):
    found = set(group_type(aplanat_bpy, name).properties.keys()) - {"rna_type", "name"}
    assert found - UNDECLARED.get(name, set()) == set(settings_of(*GROUPS[name]))


@pytest.mark.parametrize(("group", "setting"), ALL, ids=IDS)
def test_the_property_is_as_declared(aplanat_bpy, group, setting):
    prop = group_type(aplanat_bpy, group).properties[setting.name]
    assert prop.type == ("ENUM" if setting.items else KINDS[type(setting.default)])
    assert (prop.name, prop.description) == (setting.label, setting.description)
    assert not setting.description.endswith("."), "Blender adds the dot"
    if group not in NOT_OVERRIDABLE:
        assert prop.is_overridable
    if prop.type == "POINTER":
        return
    if prop.type not in {"INT", "FLOAT"}:
        assert prop.default == setting.default
    else:
        # Blender's numbers have 32 bits.
        assert prop.default == pytest.approx(setting.default, rel=1e-6)
        assert prop.hard_min <= prop.default <= prop.hard_max
        assert prop.soft_max < 2**31 - 1 or "seed" in setting.name
        for limit, bound in zip(setting.limits, (prop.hard_min, prop.hard_max), strict=True):
            assert limit is None or bound == pytest.approx(limit, rel=1e-6)
    if prop.type == "ENUM":
        items = [(item.identifier, item.value) for item in prop.enum_items]
        assert items == [(item.identifier, item.number) for item in setting.items]
        assert all(item.description for item in prop.enum_items)


def test_a_camera_starts_with_the_glass_that_stands_in_for_unknown_ones():
    assert settings_of(*CHROMATIC)["glass"].default == DEFAULT_GLASS


def test_numbers_of_choices_are_told_once():
    for _, setting in ALL:
        assert len({item.number for item in setting.items}) == len(setting.items), setting.name


def panel_sources():
    return resources().panels.sources


def test_panels_show_every_setting(context):
    panels = panels_of(_MODULES, {"PROPERTIES", "IMAGE_EDITOR", "VIEW_3D"})
    shown = set()
    for _ in states(context):
        for panel in panels:
            shown |= set(draw(panel, context, header=True).drawn)
    wanted = {(group, SHOWN_AS.get(setting.name, setting.name)) for group, setting in ALL}
    wanted -= {("AplanatSceneSettings", name) for name in settings_of(MEASURING)}
    # The editor itself shows it.
    wanted -= {("AplanatRefocusSettings", "image")}
    assert wanted <= shown, sorted(wanted - shown)


def another(setting, value):
    """Return a valid value other than the present one."""
    if isinstance(setting.default, bool):
        return not value
    if setting.items:
        return next(i.identifier for i in setting.items if i.identifier != value)
    least, most = setting.limits
    return value + 1 if most is None or value < most else least


@pytest.mark.parametrize(
    ("read", "sections"),
    [
        (lambda c: read_sampling(c.scene), [s for s in SCENE if s is not PREVIEW]),
        (lambda c: read_preview_sampling(c.scene), [PREVIEW]),
        (lambda c: describe_bokeh(c.camera, None, 0.5, panel_sources().irises)[0], BOKEH),
    ],
    ids=["render", "viewport", "bokeh"],
)
def test_readers_take_settings_as_they_are(context, read, sections):
    group = context.camera.aplanat.bokeh if sections is BOKEH else context.scene.aplanat
    settings = [setting for setting in settings_of(*sections).values() if setting.field]
    assert settings
    for setting in settings:
        value = another(setting, getattr(group, setting.name))
        setattr(group, setting.name, value)
        assert getattr(read(context), setting.field) == pytest.approx(value), setting.name


def test_fields_are_those_of_the_snapshot():
    for sections, kind in ((SCENE, Sampling), (BOKEH, BokehSettings)):
        fields = {field.name for field in dataclasses.fields(kind)}
        assert {s.field for s in settings_of(*sections).values() if s.field} <= fields


def test_a_frame_is_sampled_as_the_settings_say_and_by_no_default_of_its_own():
    declared = {s.field for s in settings_of(*SCENE).values() if s.field}
    # Decided by two settings each, by who asks, or only to measure what it does.
    decided = {"target_error", "time_limit", "reuse_grid", "progressive", "cones"}
    fields = {field.name for field in dataclasses.fields(Sampling)}
    assert declared <= fields and fields <= declared | decided


# Who reads a setting that no `field` passes on: modules of the extension, by property group.
READERS = {
    "AplanatSceneSettings": ("scene", "engine", "levels", "cli/render", "ui/focus"),
    "AplanatCaptureSettings": ("capture", "ui/operators", "cli/capture"),
    "AplanatRefocusSettings": ("engine/refocus", "ui/operators", "ui/jobs"),
    "AplanatCameraSettings": ("scene/camera",),
    "AplanatBokehSettings": ("scene/camera",),
    "AplanatChromaticSettings": ("scene/camera",),
    "AplanatMaterialSettings": ("scene/shading",),
    "AplanatLightSettings": ("scene",),
    "AplanatWorldSettings": ("scene",),
}


def test_every_setting_is_read():
    # Their names begin with what is rendered: "{prefix}_error".
    prefixed = {"render_error", "preview_error", "render_time_limit", "preview_time_limit"}
    for group, setting in ALL:
        if setting.field or setting.name in prefixed:
            continue
        read = re.compile(rf"\.{setting.name}\b(?!\()|\"{setting.name}\"")
        folders = [REPOSITORY / "addon" / folder for folder in READERS[group]]
        files = [path for folder in folders for path in folder.rglob("*.py")]
        assert any(read.search(path.read_text(encoding="utf-8")) for path in files), (
            f"{group}.{setting.name} is read nowhere in {READERS[group]}"
        )


def test_statistics_tell_every_setting(context):
    own = context.camera.aplanat
    own.chromatic.use = True
    found = settings_in_force(context.scene, panel_sources())
    for _, setting in ALL:
        if setting.told:
            part = found
            for key in setting.told.split("."):
                assert key in part, setting.told
                part = part[key]


def test_statistics_tell_what_was_set(context):
    settings, bokeh = context.scene.aplanat, context.camera.aplanat.bokeh
    settings.method, settings.render_samples, settings.seed = "REFERENCE", 40, 3
    settings.use_reference_bokeh, settings.use_sharing = True, False
    bokeh.gain, bokeh.model, bokeh.cluster_levels = 2.0, "CLUSTERED", 3
    found = settings_in_force(context.scene, panel_sources())
    wanted = {"method": "reference", "samples": 40, "seed": 3, "share_drawings": 0}
    wanted |= {"subsamples": 0, "min_samples": None, "target_error": None, "time_limit_s": None}
    assert {key: found[key] for key in wanted} == wanted
    assert (found["bokeh"]["gain"], found["bokeh"]["model"]) == (2.0, "clustered")
    assert found["bokeh"]["cluster_levels"] == 3
    settings.method, settings.subsamples = "ADAPTIVE", 2
    found = settings_in_force(context.scene, panel_sources())
    wanted = {"method": "adaptive", "samples": None, "subsamples": None, "min_samples": 16}
    assert {key: found[key] for key in wanted} == wanted
    assert found["target_error"] == pytest.approx(0.01)
    settings.use_target_error = False
    found = settings_in_force(context.scene, panel_sources())
    assert (found["samples"], found["subsamples"], found["max_samples"]) == (40, 2, None)


def test_the_page_names_every_setting():
    path = REPOSITORY / "scripts" / "pages" / "settings_page.py"
    spec = importlib.util.spec_from_file_location(path.stem, path)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    page = script.PAGE.read_text(encoding="utf-8")
    assert page == script.write(), "run scripts/pages/settings_page.py"
    for _, setting in ALL:
        assert f"| `{setting.name}` |" in page
