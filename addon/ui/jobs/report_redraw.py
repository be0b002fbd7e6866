"""Redraws property editors when there is something new in Render > Report.

Pictures are drawn in a 3D view's own drawing and by the render thread, where other areas must not
be touched; a timer of the main thread asks for news.
"""

import bpy

from ...engine.shared_resources import resources

_SECONDS = 0.5


def look():
    """Redraw the editors if there are news; return when to look again."""
    if resources().notes.take_news():
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "PROPERTIES":
                    area.tag_redraw()
    return _SECONDS


def register():
    """Begin to look, where there are windows."""
    if not bpy.app.background:
        bpy.app.timers.register(look, persistent=True)


def unregister():
    """Undo `register`."""
    if bpy.app.timers.is_registered(look):
        bpy.app.timers.unregister(look)
