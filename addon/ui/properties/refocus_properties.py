"""How a scene's captured picture is refocused."""

import bpy

from ...settings.refocus_settings import DEPTH_PASS, REFOCUS
from .declared import properties


def _is_camera(_settings, thing):
    return thing.type == "CAMERA"


class AplanatRefocusSettings(bpy.types.PropertyGroup):
    """Files, focus, f-number, and whose lens."""

    __annotations__ = properties(
        REFOCUS,
        DEPTH_PASS,
        callbacks={
            "image": {"type": bpy.types.Image},
            "camera": {"type": bpy.types.Object, "poll": _is_camera},
        },
    )
