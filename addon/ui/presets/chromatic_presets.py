"""Presets of the Chromatic Aberration panel: the shipped ones, and those a user saves."""

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from ..properties.chromatic_properties import SETTING_NAMES

# In the folder that `sampling_presets` registers.
_SUBFOLDER = "aplanat/chromatic"


class APLANAT_OT_chromatic_preset_add(AddPresetBase, bpy.types.Operator):
    """Save the chromatic settings as a preset, or remove one."""

    bl_idname = "camera.aplanat_chromatic_preset_add"
    bl_label = "Add Chromatic Preset"
    bl_description = "Save the camera's chromatic aberration as a preset, or remove a saved one"
    preset_menu = "APLANAT_PT_chromatic_presets"
    preset_subdir = _SUBFOLDER
    preset_defines = (
        'camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data',
        "chromatic = camera.aplanat.chromatic",
    )
    preset_values = tuple(f"chromatic.{name}" for name in SETTING_NAMES)


class APLANAT_PT_chromatic_presets(PresetPanel, bpy.types.Panel):
    """The list behind the button in the panel's header."""

    bl_label = "Chromatic Presets"
    preset_subdir = _SUBFOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = APLANAT_OT_chromatic_preset_add.bl_idname


CLASSES = (APLANAT_OT_chromatic_preset_add, APLANAT_PT_chromatic_presets)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
