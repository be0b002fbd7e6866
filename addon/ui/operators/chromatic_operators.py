"""Operators on the drawn curves of a camera's chromatic aberration."""

import bpy
from bpy.props import EnumProperty

from ...sampling.equalizer import EQUALIZER_PRESETS
from ...scene.camera.drawn_curves import EQUALIZER, EQUALIZER_RANGE_NM, find_mapping
from .chromatic_curves import make_group, set_points
from .lens_operators import CameraOperator, camera_of

_PRESET_ITEMS = tuple(
    (name, label, f"Draw the equalizer's curve anew: {label}")
    for name, (label, _) in EQUALIZER_PRESETS.items()
)


class APLANAT_OT_make_curves(CameraOperator, bpy.types.Operator):
    """Make the curves of a camera that lacks them, or that only has those of a library."""

    bl_idname = "camera.aplanat_make_curves"
    bl_label = "New Chromatic Curves"
    bl_description = "Make curves for this camera that can be drawn in the panel"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Make them."""
        camera = camera_of(context)
        make_group(camera.aplanat.chromatic)
        camera.update_tag()
        return {"FINISHED"}


class APLANAT_OT_equalizer_preset(CameraOperator, bpy.types.Operator):
    """Draw the curve of the spectral equalizer anew."""

    bl_idname = "camera.aplanat_equalizer_preset"
    bl_label = "Set Spectral Equalizer"
    bl_description = "Give the spectral equalizer one of the curves that come with Aplanat"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(
        name="Curve", description="Which wavelengths count", items=_PRESET_ITEMS, default="WARM"
    )

    @classmethod
    def description(cls, _context, properties):
        """Return the tooltip of this button."""
        return f"Which wavelengths count: {EQUALIZER_PRESETS[properties.preset][0]}"

    def execute(self, context):
        """Draw the curve and switch the equalizer on."""
        settings = camera_of(context).aplanat.chromatic
        group = make_group(settings)
        _, equalizer = EQUALIZER_PRESETS[self.preset]
        low, high = EQUALIZER_RANGE_NM
        points = [
            ((nm - low) / (high - low), weight, "VECTOR")
            for nm, weight in zip(equalizer.wavelengths_nm, equalizer.weights, strict=True)
        ]
        set_points(find_mapping(group, EQUALIZER), points)
        settings.mode, settings.use_equalizer = "SPECTRAL", True
        return {"FINISHED"}


class APLANAT_MT_equalizer_presets(bpy.types.Menu):
    """Curves of the equalizer that come with Aplanat."""

    bl_label = "Equalizer Curves"

    def draw(self, _context):
        """Draw one line for each."""
        self.layout.operator_enum(APLANAT_OT_equalizer_preset.bl_idname, "preset")


CLASSES = (APLANAT_OT_make_curves, APLANAT_OT_equalizer_preset, APLANAT_MT_equalizer_presets)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
