"""The Bokeh panel in Blender's window: switches, discs that follow the settings, counts."""

import numpy as np
import pytest

from .camera_editor import (
    camera_editor,
    check_that_redrawing_makes_no_picture,
    picture_of_editor,
    settle,
)

# Runs inside Blender.
NAMES = """
previews = module("ui.previews.bokeh_previews")
notes = module("engine.shared_resources").resources().notes

def bokeh():
    return camera().aplanat.bokeh

camera().dof.use_dof = bokeh().use = True
camera().dof.aperture_blades = 6
"""


@pytest.fixture
def panel(blender, display, tmp_path):
    with camera_editor(blender, display, tmp_path, "ui.panels.bokeh_panel") as window:
        window.run(NAMES)
        yield window


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
    check_that_redrawing_makes_no_picture(panel)


def test_counts_and_presets_and_odd_cameras_are_drawn_without_an_error(panel):
    for change in (
        "counts = module('engine.bokeh.stage').HighlightCounts\n"
        "counts = vars(counts(found=900, clustered=400, splatted=300))\n"
        "notes.change(bpy.context.scene, counts=counts)",
        "bokeh().model = 'CLUSTERED'",
        "bokeh().iris_image = bpy.data.images.new('black', 8, 8)",
        "bokeh().iris_image = None",
        "camera().aplanat.distortion = 'LENS'",
        "camera().aplanat.lens = 'tessar-50mm-f2.8'",
        "camera().aplanat.lens = 'no-such-lens'",
        "camera().aplanat.lens = ''; camera().aplanat.distortion = 'DIVISION'",
        "bokeh().vignetting = 'ANALYTIC'; camera().type = 'ORTHO'",
        "camera().dof.aperture_ratio = 2.0",
        "camera().dof.use_dof = False",
        "camera().dof.use_dof = True; bpy.context.scene.aplanat.method = 'REFERENCE'",
        "bokeh().use = False",
        "camera().type = 'PANO'",
    ):
        panel.run(change)
        settle(panel)


def test_presets_are_listed_and_a_shipped_one_is_applied_and_undone(panel, tmp_path):
    before = picture_of_editor(panel, tmp_path / "before.png")
    panel.run(
        "with bpy.context.temp_override(window=window(), area=editor):\n"
        "    bpy.ops.ed.undo_push(message='before')\n"
        "    bpy.ops.wm.call_panel(name='APLANAT_PT_bokeh_presets', keep_open=False)"
    )
    settle(panel)
    listed = picture_of_editor(panel, tmp_path / "listed.png")
    assert (np.abs(listed - before).max(axis=-1) > 20).sum() > 1000
    panel.run(
        "with bpy.context.temp_override(window=window(), area=editor):\n"
        "    bpy.ops.scene.aplanat_preset(kind='bokeh', preset='Swirl')"
    )
    assert panel.run("result = bokeh().vignetting") == "ANALYTIC"
    panel.run("with bpy.context.temp_override(window=window()): bpy.ops.ed.undo()")
    assert panel.run("result = bokeh().vignetting") == "LENS"
