"""How depth layers of a scene are captured."""

import bpy
from bpy.props import FloatProperty, IntProperty, StringProperty

from ...capture.settings import DEFAULT_LAYERS, DEFAULT_OVERSCAN, MOST_LAYERS, MOST_OVERSCAN


class AplanatCaptureSettings(bpy.types.PropertyGroup):
    """How many layers, how much beyond the border, and where they go."""

    layers: IntProperty(
        name="Layers",
        description="How many depth layers a captured frame has, besides the world's. More layers"
        " keep apart what lies behind one another, and take longer",
        default=DEFAULT_LAYERS,
        min=1,
        max=MOST_LAYERS,
        soft_max=16,
    )
    overscan: FloatProperty(
        name="Overscan",
        description="Share of the picture's width and height that a captured frame is larger on"
        " each side, so that blur finds what lies beyond the border",
        default=DEFAULT_OVERSCAN,
        min=0.0,
        max=MOST_OVERSCAN,
        soft_max=0.3,
        subtype="FACTOR",
        precision=2,
    )
    path: StringProperty(
        name="Layers File",
        description="Where Capture Depth Layers writes: an .exr file a frame, #### is its number",
        default="//layers_####.exr",
        subtype="FILE_PATH",
    )
