"""Bokeh of a camera: what is stored."""

import bpy

from ...settings.bokeh_settings import BOKEH
from ...settings.setting import kept_names
from .declared import properties
from .overrides import SHARED


class AplanatBokehSettings(bpy.types.PropertyGroup):
    """Bokeh settings of a camera."""

    __annotations__ = properties(
        *BOKEH, callbacks={"iris_image": {"type": bpy.types.Image}}, **SHARED
    )


# What a disc looks like: this a preset and a lens keep. An image cannot be kept as a value.
APPEARANCE_NAMES = kept_names(*BOKEH)
