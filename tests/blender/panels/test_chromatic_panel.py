"""The Chromatic Aberration panel in Blender's window: curves, previews, and a curve dragged."""

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
previews = module("ui.previews.chromatic_previews")
bar = module("ui.previews.spectrum_bar")

def chromatic():
    return camera().aplanat.chromatic

def override():
    return bpy.context.temp_override(window=window(), area=editor, camera=camera())

camera().dof.use_dof = chromatic().use = True
"""


@pytest.fixture
def panel(blender, display, tmp_path):
    panels = "ui.panels.chromatic_panel"
    # The library that knows colours is slow to load.
    with camera_editor(blender, display, tmp_path, panels, slow_library="colour") as window:
        window.run(NAMES)
        yield window


def orange(picture):
    return ((picture[..., 0] > 150) & (picture[..., 0] - picture[..., 2] > 90)).sum()


def blue(picture):
    return ((picture[..., 2] > 190) & (picture[..., 2] - picture[..., 0] > 100)).sum()


def test_previews_follow_the_settings(panel, tmp_path):
    # The axial map is what is taken away, and the pictures show what is left: t.
    panel.run("chromatic().axial_then = 'ONE_MINUS'")
    settle(panel)
    rising = picture_of_editor(panel, tmp_path / "rising.png")
    assert orange(rising) > 3000
    panel.run("chromatic().axial_first = chromatic().lateral_first = 'T_COS_THETA'")
    settle(panel)
    turning = picture_of_editor(panel, tmp_path / "turning.png")
    # Half of each disc is below zero. Switches and buttons of Blender are blue, too.
    assert blue(turning) > blue(rising) + 500
    assert orange(turning) < orange(rising)


def test_drawing_the_panel_again_makes_no_picture(panel):
    panel.run("chromatic().lateral_then = 'EXP'; chromatic().axial_first = 'CURVE'")
    settle(panel)
    check_that_redrawing_makes_no_picture(panel)


def test_a_curve_is_dragged_with_the_mouse_and_undone(panel, tmp_path):
    panel.run("chromatic().axial_first = 'CURVE'")
    settle(panel)
    panel.run(
        "with bpy.context.temp_override(window=window()): bpy.ops.ed.undo_push(message='before')"
    )
    read = (
        "result = list(module('scene.camera.drawn_curves').curve_values("
        "chromatic().curves, 'Axial First'))"
    )
    before = panel.run(read)
    path = tmp_path / "curve.png"
    picture = picture_of_editor(panel, path)
    # The curve is black; above it the widget is lighter than any other field that is as large.
    black, light = picture.max(axis=-1) < 10, np.abs(picture - 84).max(axis=-1) < 4
    rows, columns = np.nonzero(black[6:] & light[:-6])
    assert len(rows) > 100, "no curve widget"
    pick = np.argsort(columns)[len(columns) // 2]
    x, top = panel.run("result = [editor.x, window().height - editor.y - editor.height]")
    middle = x + int(columns[pick]), top + int(rows[pick]) + 6
    panel.xdotool("mousemove", *middle, "mousedown", 1)
    panel.run("result = 1")
    for step in range(1, 7):
        panel.xdotool("mousemove", middle[0], middle[1] + 12 * step)
        panel.run("result = 1")
    panel.xdotool("mouseup", 1)
    panel.run("result = 1")
    after = panel.run(read)
    # A point was made where the curve was taken, and dragged down.
    assert after[len(after) // 2] < before[len(before) // 2] - 0.1
    panel.run("with bpy.context.temp_override(window=window()): bpy.ops.ed.undo()")
    assert panel.run(read) == before


def test_the_spectrum_is_as_wide_as_the_curve_and_dims_with_it(panel, tmp_path):
    panel.run(
        "for name in ('axial', 'lateral'):\n"
        "    cls = getattr(bpy.types, f'APLANAT_CAMERA_PT_chromatic_{name}')\n"
        "    bpy.utils.unregister_class(cls)\n"
        "chromatic().use_equalizer = True"
    )
    panel.wait_for("bool(bar._colors) or editor.tag_redraw()", timeout=120)
    settle(panel)
    flat = picture_of_editor(panel, tmp_path / "flat.png")
    # The one row that has all colours, in their order.
    spread = flat - np.sort(flat, axis=-1)[..., 1:2]
    leads = [(spread[..., channel] > 40).sum(axis=1) for channel in range(3)]
    row = int(np.argmax(np.min(leads, axis=0)))
    red, green, violet = (np.flatnonzero(spread[row, :, channel] > 40) for channel in range(3))
    assert len(red) > 30 and len(green) > 20 and len(violet) > 20
    assert np.median(violet) < np.median(green) < np.median(red)
    width = panel.run("result = editor.width")
    # The last wavelengths at both ends are nearly black.
    assert violet.min() < 0.25 * width and red.max() > 0.7 * width
    panel.run("with override():\n    bpy.ops.camera.aplanat_equalizer_preset(preset='WARM')\n")
    settle(panel)
    warm = picture_of_editor(panel, tmp_path / "warm.png")

    def blues(picture):
        return ((picture[..., 2] > 150) & (picture[..., 2] - picture[..., 1] > 100)).sum()

    assert blues(warm) < blues(flat) - 100


def test_odd_cameras_are_drawn_without_an_error(panel):
    for change in (
        "chromatic().glass = 'no such glass'",
        "chromatic().dispersion = 'LENS'",
        "camera().aplanat.lens = 'tessar-50mm-f2.8'",
        "camera().aplanat.lens = 'no-such-lens'",
        "chromatic().wavelength_min = 800",
        "chromatic().axial_then = 'CURVE'; bpy.data.node_groups.remove(chromatic().curves)",
        "chromatic().mode = 'RGB'",
        "camera().type = 'ORTHO'",
        "camera().dof.use_dof = False",
        "chromatic().use = False",
        "camera().type = 'PANO'",
    ):
        panel.run(change)
        settle(panel)
