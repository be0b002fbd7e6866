"""Presets: shipped ones as data, and a user's own as Blender's scripts."""

from types import SimpleNamespace

import pytest

from addon.sampling.field_maps import FIELD_PRESETS, FieldMap
from addon.scene.camera.chromatic import read_field_map
from addon.settings.setting import kept_names, settings_of
from addon.ui.presets.preset_menus import KINDS, PRESET_CLASSES, APLANAT_OT_preset
from addon.ui.properties.lens_memory import values_of

from .panel_drawing import Layout

# Float properties have 32 bits.
SINGLE = 1e-6
SHIPPED = [(kind, preset) for kind, what in KINDS.items() for preset in what.shipped]
# A preset of bokeh as Aplanat 0.1 saved it.
SAVED_BY_0_1 = """import bpy
camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data
bokeh = camera.aplanat.bokeh

bokeh.hardness = -0.25
bokeh.vignetting = 'ANALYTIC'
bokeh.dust = 7
"""


@pytest.fixture
def groups(camera, empty_scene):
    """The property group of each kind."""
    own = camera.aplanat
    found = {"sampling": empty_scene.aplanat, "bokeh": own.bokeh, "chromatic": own.chromatic}
    return found | {"aberrations": own}


def apply(bpy, kind, name):
    assert bpy.ops.scene.aplanat_preset(kind=kind, preset=name) == {"FINISHED"}


def kept(kind, group):
    return values_of(group, kept_names(*KINDS[kind].sections))


def spoil(kind, group):
    """Give every setting that presets keep another value."""
    settings = settings_of(*KINDS[kind].sections)
    for name in kept_names(*KINDS[kind].sections):
        prop = group.bl_rna.properties[name]
        if prop.type == "ENUM":
            setattr(
                group,
                name,
                next(i.identifier for i in prop.enum_items if i.identifier != prop.default),
            )
        elif prop.type == "BOOLEAN":
            setattr(group, name, not prop.default)
        elif prop.type == "STRING":
            group.glass = "F2"
        else:
            setattr(group, name, settings[name].limits[0])


@pytest.mark.parametrize(("kind", "preset"), SHIPPED, ids=[f"{k} {p.name}" for k, p in SHIPPED])
def test_a_shipped_preset_sets_everything_that_presets_keep(groups, aplanat_bpy, kind, preset):
    spoil(kind, groups[kind])
    apply(aplanat_bpy, kind, preset.name)
    settings = settings_of(*KINDS[kind].sections)
    for name, value in kept(kind, groups[kind]).items():
        wanted = preset.values.get(name, settings[name].default)
        assert value == (wanted if isinstance(wanted, str) else pytest.approx(wanted, rel=SINGLE))
    assert set(preset.values) <= set(kept(kind, groups[kind]))
    assert preset.description and not preset.description.endswith("."), "Blender adds the dot"


def listed(kind):
    """Return the layout into which a list of presets is drawn, Blender's part of it included."""
    _, listing = PRESET_CLASSES[kind]
    # Of Blender's panels no instance can be made.
    plain = type("Listing", (listing.__bases__[0],), dict(vars(listing)))()
    plain.layout, plain.bl_idname = Layout(), listing.__name__
    plain.draw(SimpleNamespace())
    return plain.layout


def test_the_menus_have_the_shipped_presets_in_order(groups, preset_folder):
    wanted = {
        "sampling": ["Draft", "Preview", "Final"],
        "bokeh": ["Clean", "Soap Bubble", "Creamy", "Swirl", "Vintage", "Dusty", "Aspheric"],
        "chromatic": [
            *("Standard", "Subtle", "Showcase", "Spread", "Reversed"),
            *("Steep", "Wheel", "Butterfly", "Centre", "Rings"),
        ],
        "aberrations": [
            *("None", "Soft Focus", "Soap Bubbles", "Swirl", "Single Lens", "Comets"),
        ],
    }
    for kind in KINDS:
        layout = listed(kind)
        shipped = [o for o in layout.operators if o.operator == "scene.aplanat_preset"]
        assert [o.preset for o in shipped] == [o.text for o in shipped] == wanted[kind]
        assert {o.kind for o in shipped} == {kind}
        assert "Missing" not in " ".join(layout.labels)


def test_own_presets_stand_below_the_shipped_ones(groups, aplanat_bpy, preset_folder):
    for name in ("Zebra", "Apple"):
        aplanat_bpy.ops.camera.aplanat_bokeh_preset_add(name=name)
    operators = listed("bokeh").operators
    own = [o.text for o in operators if o.operator == "script.execute_preset"]
    assert own == ["Apple", "Zebra"]
    names = [o.operator for o in operators]
    assert names.index("script.execute_preset") > names.index("scene.aplanat_preset") + 6
    assert "camera.aplanat_bokeh_preset_add" in names


def test_tooltips_tell_what_a_shipped_preset_is_for():
    operator = APLANAT_OT_preset
    told = operator.description(None, SimpleNamespace(kind="bokeh", preset="Dusty"))
    assert told == "A lens that was not cleaned for long"


def test_an_unknown_preset_and_a_missing_camera_are_told(aplanat_bpy, empty_scene):
    with pytest.raises(RuntimeError, match="no preset 'Drft'; there are Draft, Preview, Final"):
        aplanat_bpy.ops.scene.aplanat_preset(kind="sampling", preset="Drft")
    with pytest.raises(RuntimeError, match="Bokeh presets: no camera"):
        aplanat_bpy.ops.scene.aplanat_preset(kind="bokeh", preset="Clean")


@pytest.mark.parametrize("kind", KINDS)
def test_an_own_preset_is_saved_loaded_and_removed(
    groups, aplanat_bpy, preset_folder, kind, camera, empty_scene
):
    bpy = aplanat_bpy
    add, listing = PRESET_CLASSES[kind]
    module, name = add.bl_idname.split(".")
    operator = getattr(getattr(bpy.ops, module), name)
    spoil(kind, groups[kind])
    before = kept(kind, groups[kind])
    assert operator(name="Mine") == {"FINISHED"}
    (saved,) = preset_folder.rglob("Mine.py")
    apply(bpy, kind, KINDS[kind].shipped[0].name)
    assert kept(kind, groups[kind]) != before
    bpy.ops.script.execute_preset(filepath=str(saved), menu_idname=listing.__name__)
    assert kept(kind, groups[kind]) == before
    assert operator(name="Mine", remove_name=True) == {"FINISHED"}
    assert not saved.exists()
    # Shipped ones are not there to be removed.
    shipped = KINDS[kind].shipped[0].name
    assert operator(name=shipped, remove_name=True) == {"CANCELLED"}
    assert add.bl_description


def test_a_preset_that_0_1_saved_can_be_loaded(camera, aplanat_bpy, tmp_path):
    file = tmp_path / "Old.py"
    file.write_text(SAVED_BY_0_1, encoding="utf-8")
    aplanat_bpy.ops.script.execute_preset(
        filepath=str(file), menu_idname="APLANAT_PT_bokeh_presets"
    )
    bokeh = camera.aplanat.bokeh
    assert (bokeh.hardness, bokeh.vignetting, bokeh.dust) == (-0.25, "ANALYTIC", 7)


def test_presets_of_sampling_rise_and_leave_the_lens_alone(groups, aplanat_bpy, camera):
    camera.dof.aperture_fstop = 1.25
    samples = []
    for name in ("Draft", "Preview", "Final"):
        apply(aplanat_bpy, "sampling", name)
        samples.append((groups["sampling"].preview_samples, groups["sampling"].render_samples))
    assert samples == sorted(samples) and len(set(samples)) == 3
    assert camera.dof.aperture_fstop == 1.25
    assert aplanat_bpy.context.scene.render.filter_size == 1.5


def test_clean_is_how_a_camera_starts(groups, aplanat_bpy):
    start = kept("bokeh", groups["bokeh"])
    apply(aplanat_bpy, "bokeh", "Vintage")
    assert kept("bokeh", groups["bokeh"]) != start
    apply(aplanat_bpy, "bokeh", "Clean")
    assert kept("bokeh", groups["bokeh"]) == start


def test_soap_bubble_and_creamy_are_opposites(groups, aplanat_bpy):
    apply(aplanat_bpy, "bokeh", "Soap Bubble")
    assert groups["bokeh"].hardness > 0.5
    apply(aplanat_bpy, "bokeh", "Creamy")
    assert groups["bokeh"].hardness < -0.5


def test_a_preset_of_bokeh_leaves_search_light_and_debug_view_alone(groups, aplanat_bpy):
    wanted = {
        "threshold": 3.0,
        "model": "CLUSTERED",
        "visibility": "SPLAT",
        "debug_view": "SOURCES",
    }
    for name, value in wanted.items():
        setattr(groups["bokeh"], name, value)
    apply(aplanat_bpy, "bokeh", "Swirl")
    assert values_of(groups["bokeh"], wanted) == wanted


def test_presets_are_the_field_maps_of_the_papers_figures(groups, aplanat_bpy):
    chromatic = groups["chromatic"]
    for label, axial, lateral in FIELD_PRESETS.values():
        chromatic.use = False
        apply(aplanat_bpy, "chromatic", label)
        assert chromatic.use
        assert read_field_map(chromatic, "axial") == axial, label
        assert read_field_map(chromatic, "lateral") == lateral, label
    apply(aplanat_bpy, "chromatic", "Showcase")
    assert read_field_map(chromatic, "axial") == FieldMap("ONE_MINUS", "RECIPROCAL")
    assert read_field_map(chromatic, "lateral") == FieldMap("ONE_MINUS", "RECIPROCAL")
