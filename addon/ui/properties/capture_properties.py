"""How depth layers of a scene are captured."""

import bpy

from ...settings.scene_settings import CAPTURE
from .declared import properties


class AplanatCaptureSettings(bpy.types.PropertyGroup):
    """How many layers, how much beyond the border, and where they go."""

    __annotations__ = properties(CAPTURE)
