"""A properties editor of the camera in Blender's window: shared by the tests of its panels."""

from contextlib import contextmanager

import imageio.v3 as iio

# Runs inside Blender. Code that is run later finds these names, too.
STAGE = """
import importlib
import bpy

ADDON = "bl_ext.user_default.aplanat"

def module(name):
    return importlib.import_module(f"{ADDON}.addon.{name}")

def window():
    return bpy.context.window_manager.windows[0]

def camera():
    return bpy.data.objects["Camera"].data

def largest():
    return max(window().screen.areas, key=lambda area: area.width * area.height)

def show_camera(area):
    area.type = "PROPERTIES"
    area.spaces.active.context = "DATA"

bpy.context.scene.render.engine = "APLANAT"
bpy.context.view_layer.objects.active = bpy.data.objects["Camera"]
for thing in bpy.context.selected_objects:
    thing.select_set(thing.name == "Camera")
"""
# Opens the panels of one module, and leaves out all other panels of the camera.
ALONE = """
panel = module("{panels}")
panel.unregister()
for cls in panel.CLASSES:
    cls.bl_options = set()
panel.register()
for name in dir(bpy.types):
    cls = getattr(bpy.types, name)
    if getattr(cls, "bl_context", "") == "data" and "PT_" in name and cls not in panel.CLASSES:
        if name != "DATA_PT_context_camera" and cls.is_registered:
            bpy.utils.unregister_class(cls)
view = largest()
with bpy.context.temp_override(window=window(), area=view, region=view.regions[-1]):
    bpy.ops.screen.area_split(direction="VERTICAL", factor=0.42)
"""
EDITOR = """
editor = min((a for a in window().screen.areas if a.type == "VIEW_3D"), key=lambda area: area.x)
show_camera(editor)
"""


@contextmanager
def camera_editor(blender, display, folder, panels=None, slow_library=None):
    """Open Blender with a properties editor that shows the camera.

    Parameters
    ----------
    blender, display : fixtures
    folder : Path
        For what Blender leaves; the cache is there, too.
    panels : str, optional
        The module whose panels are shown, alone and opened, in the area `editor`; without it, the
        largest area shows all panels.
    slow_library : str, optional
        What is slow to load, and must not be there before a panel needs it.

    Yields
    ------
    object
        The window.
    """
    env = {"APLANAT_CACHE": str(folder / "cache")}
    with blender.window(display, folder=folder / "panel", env=env) as window:
        if slow_library:
            assert window.run(f"result = '{slow_library}' not in __import__('sys').modules")
        window.run(STAGE)
        if panels:
            window.run(ALONE.replace("{panels}", panels))
            window.run(EDITOR)
        else:
            window.run("show_camera(largest())")
        yield window
        log = window.log.read_text()
        assert "Traceback" not in log, log


def picture_of_editor(window, path):
    """Return the editor's pixels, the first row at its top."""
    x, top, width, height = window.run(
        "result = [editor.x, window().height - editor.y - editor.height, editor.width,"
        " editor.height]"
    )
    return iio.imread(window.screenshot(path))[top : top + height, x : x + width, :3].astype(int)


def settle(window):
    """Wait until what was set is drawn."""
    for _ in range(2):
        window.run("editor.tag_redraw()")
        window.run("result = 1")


def check_that_redrawing_makes_no_picture(window):
    """Draw the editor again; the global name `previews` must be the module of its icons."""
    window.run(
        "region = next(r for r in editor.regions if r.type == 'WINDOW')\n"
        "def draw(times):\n"
        "    with bpy.context.temp_override(window=window(), area=editor, region=region):\n"
        "        bpy.ops.wm.redraw_timer(type='DRAW', iterations=times)\n"
        "draw(2); shown = dict(previews.icons.shown); draw(10)\n"
        "assert shown == previews.icons.shown"
    )
