"""Presets of sampling, bokeh and aberrations: the shipped ones, and those that a user saves.

Shipped presets are data (`settings.shipped_presets`), applied by one operator; they can neither be
overwritten nor removed. A user's own are scripts in Blender's folder of presets, saved, run and
removed by Blender.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel
from bpy.props import EnumProperty, StringProperty

from ...settings.bokeh_settings import BOKEH
from ...settings.chromatic_settings import CHROMATIC
from ...settings.scene_part_settings import ABERRATIONS
from ...settings.scene_settings import SCENE
from ...settings.setting import Section, changed, kept_names, settings_of
from ...settings.shipped_presets import (
    ABERRATION_PRESETS,
    BOKEH_PRESETS,
    CHROMATIC_PRESETS,
    SAMPLING_PRESETS,
    Preset,
)
from ..operators.lens_operators import camera_of
from ..properties.chromatic_properties import SETTING_NAMES


@dataclass(frozen=True)
class _Kind:
    """What presets are of.

    Parameters
    ----------
    label : str
    what : str
        For tooltips.
    owner : str
        Of the operator's name: the module of `bpy.ops`.
    sections : tuple of Section
    shipped : tuple of Preset
    group : callable
        From a context to the property group, or None where there is none.
    lines : tuple of str
        How a user's preset finds it: names stay as they are, presets of users begin so.
    names : tuple of str
        What a user's preset sets, as Python writes it behind those lines.
    beside : dict of str
        Blender's own settings of a scene's render that a shipped preset sets.
    """

    label: str
    what: str
    owner: str
    sections: tuple[Section, ...]
    shipped: tuple[Preset, ...]
    group: object
    lines: tuple[str, ...]
    names: tuple[str, ...]
    beside: Mapping[str, object] = field(default_factory=dict)


def _group_of_camera(name):
    def group(context):
        camera = camera_of(context)
        return None if camera is None else getattr(camera.aplanat, name)

    return group


def _camera_settings(context):
    camera = camera_of(context)
    return None if camera is None else camera.aplanat


_CAMERA = 'camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data'
KINDS = {
    "sampling": _Kind(
        "Sampling",
        "these sampling settings",
        "render",
        SCENE,
        SAMPLING_PRESETS,
        lambda context: context.scene.aplanat,
        ("scene = bpy.context.scene",),
        (*(f"scene.aplanat.{name}" for name in kept_names(*SCENE)), "scene.render.filter_size"),
        {"filter_size": 1.5},
    ),
    "bokeh": _Kind(
        "Bokeh",
        "the appearance of the camera's bokeh",
        "camera",
        BOKEH,
        BOKEH_PRESETS,
        _group_of_camera("bokeh"),
        (_CAMERA, "bokeh = camera.aplanat.bokeh"),
        tuple(f"bokeh.{name}" for name in kept_names(*BOKEH)),
    ),
    "chromatic": _Kind(
        "Chromatic",
        "the camera's chromatic aberration",
        "camera",
        CHROMATIC,
        CHROMATIC_PRESETS,
        _group_of_camera("chromatic"),
        (_CAMERA, "chromatic = camera.aplanat.chromatic"),
        tuple(f"chromatic.{name}" for name in SETTING_NAMES),
    ),
    "aberrations": _Kind(
        "Aberrations",
        "the aberrations of a lens without a prescription",
        "camera",
        (ABERRATIONS,),
        ABERRATION_PRESETS,
        _camera_settings,
        (_CAMERA,),
        tuple(f"camera.aplanat.{name}" for name in kept_names(ABERRATIONS)),
    ),
}


class APLANAT_OT_preset(bpy.types.Operator):
    """Apply a preset that comes with Aplanat."""

    bl_idname = "scene.aplanat_preset"
    bl_label = "Apply Preset"
    bl_description = "Apply a preset that comes with Aplanat"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    kind: EnumProperty(
        name="Kind",
        description="What is set",
        items=tuple(
            (name, kind.label, f"Sets {kind.what}", "NONE", number)
            for number, (name, kind) in enumerate(KINDS.items())
        ),
    )
    preset: StringProperty(name="Preset", description="Its name in the menu")

    @classmethod
    def description(cls, _context, properties):
        """Tell what the preset is for."""
        found = _shipped(KINDS[properties.kind], properties.preset)
        return found.description if found else cls.bl_description

    def execute(self, context):
        """Set everything that presets of this kind keep."""
        kind = KINDS[self.kind]
        preset, group = _shipped(kind, self.preset), kind.group(context)
        if preset is None or group is None:
            names = ", ".join(one.name for one in kind.shipped)
            missing = f"no preset '{self.preset}'; there are {names}" if group else "no camera"
            self.report({"ERROR"}, f"{kind.label} presets: {missing}")
            return {"CANCELLED"}
        values = changed(settings_of(*kind.sections), kept_names(*kind.sections), **preset.values)
        for name, value in values.items():
            setattr(group, name, value)
        for name, value in kind.beside.items():
            setattr(context.scene.render, name, value)
        return {"FINISHED"}


def _shipped(kind, name):
    return next((preset for preset in kind.shipped if preset.name == name), None)


class _Presets(PresetPanel):
    """The list behind the button in a panel's header: shipped presets above the user's own."""

    kind = ""
    preset_operator = "script.execute_preset"

    def draw(self, context):
        """Draw a button for each."""
        layout = self.layout
        layout.emboss = "PULLDOWN_MENU"
        layout.operator_context = "EXEC_DEFAULT"
        shipped = layout.column(align=True)
        for preset in KINDS[self.kind].shipped:
            button = shipped.operator(
                APLANAT_OT_preset.bl_idname, text=preset.name, translate=False
            )
            button.kind, button.preset = self.kind, preset.name
        if bpy.utils.preset_paths(self.preset_subdir):
            layout.separator()
        super().draw(context)

    def path_menu(self, searchpaths, operator, **options):
        """Draw the user's own; there need not be a folder of them yet."""
        # Blender complains about a list without a folder; an iterator is no empty list.
        bpy.types.Menu.path_menu(self, iter(searchpaths), operator, **options)


def _classes(name, kind):
    """Return the operator that saves and removes a user's presets, and the panel that lists all."""
    subfolder, panel = f"aplanat/{name}", f"APLANAT_PT_{name}_presets"
    add = {
        "__doc__": f"Save {kind.what} as a preset, or remove one.",
        "bl_idname": f"{kind.owner}.aplanat_{name}_preset_add",
        "bl_label": f"Add {kind.label} Preset",
        "bl_description": f"Save {kind.what} as a preset, or remove a saved one",
        "preset_menu": panel,
        "preset_subdir": subfolder,
        "preset_defines": kind.lines,
        "preset_values": kind.names,
    }
    listing = {
        "__doc__": f"Presets of {kind.what}.",
        "bl_label": f"{kind.label} Presets",
        "kind": name,
        "preset_subdir": subfolder,
        "preset_add_operator": add["bl_idname"],
    }
    return (
        type(f"APLANAT_OT_{name}_preset_add", (AddPresetBase, bpy.types.Operator), add),
        type(panel, (_Presets, bpy.types.Panel), listing),
    )


# By kind: the operator and the panel.
PRESET_CLASSES = {name: _classes(name, kind) for name, kind in KINDS.items()}
CLASSES = (APLANAT_OT_preset, *(one for pair in PRESET_CLASSES.values() for one in pair))

register, unregister = bpy.utils.register_classes_factory(CLASSES)
