"""Bokeh and Chromatic Aberration follow Depth of Field, among Blender's panels of the camera.

Blender shows panels in the order in which they were registered, and has no place for one between
two others. Those that are to stand behind ours are registered once more: they keep all that they
are, and go to the end. There is nothing to undo, since their own order stays.
"""

import bpy

from .blender_panels import subclasses

# Blender's panels of the camera behind Depth of Field, in their order.
BEHIND = (
    "DATA_PT_camera",
    "DATA_PT_camera_stereoscopy",
    "DATA_PT_camera_safe_areas",
    "DATA_PT_camera_background_image",
    "DATA_PT_camera_display",
)


def register():
    """Move Blender's panels to the end, each with what hangs on it."""
    for name in BEHIND:
        panel = getattr(bpy.types, name, None)
        if panel is not None:
            _register_again([panel, *_hanging_on(name)])


def unregister():
    """Nothing is left to undo."""


def _hanging_on(name):
    """Return the panels below one, parents before children."""
    for panel in subclasses(bpy.types.Panel):
        if getattr(panel, "bl_parent_id", "") == name and panel.is_registered:
            yield panel
            yield from _hanging_on(panel.__name__)


def _register_again(family):
    for panel in reversed(family):
        bpy.utils.unregister_class(panel)
    for panel in family:
        bpy.utils.register_class(panel)
