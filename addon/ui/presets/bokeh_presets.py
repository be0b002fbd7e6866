"""Presets of the bokeh's appearance: the shipped ones, and those a user saves."""

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from ..properties.bokeh_properties import APPEARANCE_NAMES

# In the folder that `sampling_presets` registers.
_SUBFOLDER = "aplanat/bokeh"


class APLANAT_OT_bokeh_preset_add(AddPresetBase, bpy.types.Operator):
    """Save the appearance of the bokeh as a preset, or remove one."""

    bl_idname = "camera.aplanat_bokeh_preset_add"
    bl_label = "Add Bokeh Preset"
    bl_description = "Save the appearance of the camera's bokeh as a preset, or remove a saved one"
    preset_menu = "APLANAT_PT_bokeh_presets"
    preset_subdir = _SUBFOLDER
    preset_defines = (
        'camera = getattr(bpy.context, "camera", None) or bpy.context.scene.camera.data',
        "bokeh = camera.aplanat.bokeh",
    )
    preset_values = tuple(f"bokeh.{name}" for name in APPEARANCE_NAMES)


class APLANAT_PT_bokeh_presets(PresetPanel, bpy.types.Panel):
    """The list behind the button in the header of the appearance."""

    bl_label = "Bokeh Presets"
    preset_subdir = _SUBFOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = APLANAT_OT_bokeh_preset_add.bl_idname


CLASSES = (APLANAT_OT_bokeh_preset_add, APLANAT_PT_bokeh_presets)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
