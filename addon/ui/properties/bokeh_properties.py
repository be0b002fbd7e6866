"""Bokeh of a camera: what is stored."""

import bpy
from bpy.props import EnumProperty, FloatProperty

from ...settings.bokeh_settings import BOKEH
from ...settings.scene_part_settings import DISTORTION
from ...settings.setting import kept_names, settings_of
from .declared import properties
from .overrides import OVERRIDABLE, SHARED, setting_changed

_OLD = {"options": {"HIDDEN"}, "override": OVERRIDABLE}


def _threshold_changed(settings, context):
    """Let the threshold count that was set."""
    settings.highlights = "THRESHOLD"
    setting_changed(settings, context)


class AplanatBokehSettings(bpy.types.PropertyGroup):
    """Bokeh settings of a camera."""

    __annotations__ = {
        **properties(
            *BOKEH,
            callbacks={
                "iris_image": {"type": bpy.types.Image},
                "threshold": {"update": _threshold_changed},
            },
            **SHARED,
        ),
        # Of files before version 2, for library overrides: see `migrations`.
        "distortion_source": EnumProperty(
            name="Distortion",
            description="Moved to the lens",
            items=tuple(
                (item.identifier, item.label, "", "NONE", item.number)
                for item in settings_of(DISTORTION)["distortion"].items
            ),
            **_OLD,
        ),
        "distortion": FloatProperty(name="K", description="Moved to the lens", **_OLD),
    }


# What a disc looks like: this a preset and a lens keep. An image cannot be kept as a value.
APPEARANCE_NAMES = kept_names(*BOKEH)
