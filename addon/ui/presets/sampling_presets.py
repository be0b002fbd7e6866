"""Presets of the Sampling panel: the shipped ones, and those a user saves."""

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

_SUBFOLDER = "aplanat/sampling"
# Blender looks below it for presets/aplanat/sampling.
_FOLDER = str(Path(__file__).resolve().parents[1])


class APLANAT_OT_sampling_preset_add(AddPresetBase, bpy.types.Operator):
    """Save the sampling settings as a preset, or remove one."""

    bl_idname = "render.aplanat_sampling_preset_add"
    bl_label = "Add Sampling Preset"
    bl_description = "Save these sampling settings as a preset, or remove a saved one"
    preset_menu = "APLANAT_PT_sampling_presets"
    preset_subdir = _SUBFOLDER
    preset_defines = ("scene = bpy.context.scene",)
    preset_values = (
        "scene.aplanat.method",
        "scene.aplanat.use_target_error",
        "scene.aplanat.render_error",
        "scene.aplanat.preview_error",
        "scene.aplanat.render_min_samples",
        "scene.aplanat.preview_min_samples",
        "scene.aplanat.render_max_samples",
        "scene.aplanat.preview_max_samples",
        "scene.aplanat.render_samples",
        "scene.aplanat.preview_samples",
        "scene.aplanat.subsamples",
        "scene.aplanat.use_sharing",
        "scene.aplanat.sharing_cells",
        "scene.aplanat.pixel_filter",
        "scene.render.filter_size",
    )


class APLANAT_PT_sampling_presets(PresetPanel, bpy.types.Panel):
    """The list behind the button in the panel's header."""

    bl_label = "Sampling Presets"
    preset_subdir = _SUBFOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = APLANAT_OT_sampling_preset_add.bl_idname


CLASSES = (APLANAT_OT_sampling_preset_add, APLANAT_PT_sampling_presets)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the classes and the folder of the shipped presets."""
    _register()
    bpy.utils.register_preset_path(_FOLDER)


def unregister():
    """Undo `register`."""
    bpy.utils.unregister_preset_path(_FOLDER)
    _unregister()
