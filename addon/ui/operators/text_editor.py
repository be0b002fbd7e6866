"""Showing a file in Blender's text editor."""

from pathlib import Path

import bpy


def show_text(context, path):
    """Open a file as a text, in a text editor if there is one, else in a new window.

    Parameters
    ----------
    context : bpy.types.Context
    path : Path

    Returns
    -------
    bpy.types.Text
    """
    path = Path(path)
    text = next((text for text in bpy.data.texts if _path_of(text) == path), None)
    text = text or bpy.data.texts.load(str(path))
    space = _text_space(context)
    if space is not None:
        space.text = text
        space.top = 0
        space.show_line_numbers = True
    return text


def _path_of(text):
    return Path(bpy.path.abspath(text.filepath)) if text.filepath else None


def _text_space(context):
    windows = context.window_manager.windows
    current = [context.window] if context.window else []
    for window in (*current, *windows):
        for area in window.screen.areas:
            if area.type == "TEXT_EDITOR":
                return area.spaces.active
    if not bpy.ops.wm.window_new.poll():
        return None
    before = {window.as_pointer() for window in windows}
    bpy.ops.wm.window_new()
    opened = next((window for window in windows if window.as_pointer() not in before), None)
    if opened is None:
        return None
    area = max(opened.screen.areas, key=lambda area: area.width * area.height)
    area.type = "TEXT_EDITOR"
    return area.spaces.active
