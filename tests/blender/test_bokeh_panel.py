"""The Bokeh panel in Blender's window: switches, discs that follow the settings, counts."""

import imageio.v3 as iio
import numpy as np
import pytest

# Runs inside Blender: a properties editor that shows nothing of the camera but this panel, opened.
STAGE = """
import importlib
import bpy

ADDON = "bl_ext.user_default.aplanat"

def module(name):
    return importlib.import_module(f"{ADDON}.addon.{name}")

panel = module("ui.panels.bokeh_panel")
previews = module("ui.previews.bokeh_previews")
notes = module("engine.shared_resources").resources().notes

def window():
    return bpy.context.window_manager.windows[0]

def camera():
    return bpy.data.objects["Camera"].data

def bokeh():
    return camera().aplanat.bokeh

bpy.context.scene.render.engine = "APLANAT"
bpy.context.view_layer.objects.active = bpy.data.objects["Camera"]
for thing in bpy.context.selected_objects:
    thing.select_set(thing.name == "Camera")
panel.unregister()
for cls in panel.CLASSES:
    cls.bl_options = set()
panel.register()
for name in dir(bpy.types):
    cls = getattr(bpy.types, name)
    if getattr(cls, "bl_context", "") == "data" and "PT_" in name and cls not in panel.CLASSES:
        if name != "DATA_PT_context_camera" and cls.is_registered:
            bpy.utils.unregister_class(cls)
view = max(window().screen.areas, key=lambda area: area.width * area.height)
with bpy.context.temp_override(window=window(), area=view, region=view.regions[-1]):
    bpy.ops.screen.area_split(direction="VERTICAL", factor=0.42)
"""
EDITOR = """
editor = min((a for a in window().screen.areas if a.type == "VIEW_3D"), key=lambda area: area.x)
editor.type = "PROPERTIES"
editor.spaces.active.context = "DATA"
camera().dof.use_dof = True
camera().aplanat.bokeh.use = True
camera().dof.aperture_blades = 6
"""


@pytest.fixture
def panel(blender, display, tmp_path):
    env = {"APLANAT_CACHE": str(tmp_path / "cache")}
    with blender.window(display, folder=tmp_path / "panel", env=env) as window:
        window.run(STAGE)
        window.run(EDITOR)
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


def rows_of_discs(picture):
    """Return the rows of the three pictures of discs."""
    # Their ground is darker than anything else in the panel.
    dark = picture.max(axis=-1) < 12
    rows = np.flatnonzero(dark.sum(axis=1) > 30)
    assert len(rows) > 60, "no discs"
    return slice(rows[0], rows[-1] + 1)


def test_discs_follow_the_settings(panel, tmp_path):
    settle(panel)
    clean = picture_of_editor(panel, tmp_path / "clean.png")
    rows = rows_of_discs(clean)
    panel.run("bokeh().hardness = 0.9; bokeh().vignetting = 'ANALYTIC'")
    panel.run("bokeh().vignetting_strength = 1.0")
    settle(panel)
    shaped = picture_of_editor(panel, tmp_path / "shaped.png")
    difference = np.abs(shaped - clean).max(axis=-1)[rows]
    # The three discs changed: in front, behind, and the cat's eye in the corner.
    assert (difference > 20).sum() > 1000
    panel.run("bokeh().hardness = 0.0; bokeh().vignetting = 'LENS'")
    settle(panel)
    again = picture_of_editor(panel, tmp_path / "again.png")
    assert (np.abs(again - clean).max(axis=-1)[rows] > 20).sum() == 0


def test_drawing_the_panel_again_draws_no_discs(panel):
    panel.run("bokeh().grain = 0.2; bokeh().dust = 40")
    settle(panel)
    panel.run(
        "region = next(r for r in editor.regions if r.type == 'WINDOW')\n"
        "def draw(times):\n"
        "    with bpy.context.temp_override(window=window(), area=editor, region=region):\n"
        "        bpy.ops.wm.redraw_timer(type='DRAW', iterations=times)\n"
        "draw(2); shown = dict(previews.icons.shown); draw(10)\n"
        "assert shown == previews.icons.shown"
    )


def test_counts_and_presets_and_odd_cameras_are_drawn_without_an_error(panel):
    for change in (
        "counts = module('engine.bokeh.stage').HighlightCounts\n"
        "counts = vars(counts(found=900, clustered=400, splatted=300))\n"
        "notes.change(bpy.context.scene, counts=counts)",
        "bokeh().model = 'CLUSTERED'",
        "bokeh().iris_image = bpy.data.images.new('black', 8, 8)",
        "bokeh().iris_image = None",
        "bokeh().distortion_source = 'LENS'",
        "camera().aplanat.lens = 'tessar-50mm-f2.8'",
        "camera().aplanat.lens = 'no-such-lens'",
        "camera().aplanat.lens = ''; bokeh().distortion_source = 'DIVISION'",
        "bokeh().vignetting = 'ANALYTIC'; camera().type = 'ORTHO'",
        "camera().dof.aperture_ratio = 2.0",
        "camera().dof.use_dof = False",
        "camera().dof.use_dof = True; bpy.context.scene.aplanat.method = 'REFERENCE'",
        "bokeh().use = False",
        "camera().type = 'PANO'",
    ):
        panel.run(change)
        settle(panel)
    panel.run("camera().type = 'PERSP'; scene = bpy.context.scene")
    applied = panel.run(
        "scene.camera = bpy.data.objects['Camera']\n"
        "bpy.ops.scene.aplanat_preset(kind='bokeh', preset='Swirl')\n"
        "result = abs(bokeh().hardness - 0.2) < 1e-6"
    )
    assert applied, "the extension came without its presets"
