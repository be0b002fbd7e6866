"""The Real Lens panel in Blender's window: chosen with the mouse, made in the background."""

import imageio.v3 as iio
import numpy as np
import pytest

from .camera_editor import STAGE, camera_editor

# Runs inside Blender.
NAMES = """
background = module("ui.jobs.background")
thumbnails = module("ui.previews.lens_thumbnails")
library = module("engine.shared_resources").shelf()
editor = largest

def drawn(lens_id):
    return thumbnails.icons.icon_id(f"lens:{lens_id}") != 0
"""


def show_again(window):
    window.run(STAGE)
    window.run("show_camera(largest())")
    window.run(NAMES)


@pytest.fixture
def panel(blender, display, tmp_path):
    # The cache is a new one: every picture is made.
    with camera_editor(blender, display, tmp_path, slow_library="matplotlib") as window:
        window.run(NAMES)
        yield window


def below_blenders_lens_panel(window):
    """Where on the screen the chooser is, found by looking for it: the place of a thumbnail."""
    x, top, width = window.run(
        "area = editor(); result = [area.x, window().height - area.y - area.height, area.width]"
    )
    return x + width // 2, top + 460


def test_lenses_are_drawn_while_the_window_answers(panel, tmp_path):
    panel.run("camera().aplanat.lens = 'sonnar-50mm-f1.5'")
    panel.wait_for("background.progress() is not None", timeout=30)
    # It answers at once although the work takes seconds.
    for _ in range(5):
        assert panel.run("result = 1", timeout=5) == 1
    panel.wait_for("drawn('sonnar-50mm-f1.5')", timeout=120)
    panel.wait_for("all(drawn(i) for i in library.ids())", timeout=240)
    panel.wait_for("background.progress() is None", timeout=30)
    assert not panel.run("result = background._errors")
    picture = iio.imread(panel.screenshot(tmp_path / "panel.png"))[..., :3]
    x, y = below_blenders_lens_panel(panel)
    chooser = picture[y - 90 : y + 90, x - 90 : x + 90].astype(int)
    # Rays of the axis are orange: nothing of Blender's is, in that place.
    orange = (chooser[..., 0] > 150) & (chooser[..., 0] - chooser[..., 2] > 60)
    assert orange.sum() > 50


def test_a_lens_is_chosen_with_the_mouse_and_undone(panel, tmp_path):
    panel.run("camera().aplanat.lens = 'tessar-50mm-f2.8'; camera().lens = 35")
    panel.run(
        "with bpy.context.temp_override(window=window()): bpy.ops.ed.undo_push(message='before')"
    )
    panel.wait_for("background.progress() is None and drawn('tessar-50mm-f2.8')", timeout=240)
    x, y = below_blenders_lens_panel(panel)
    panel.xdotool("mousemove", x, y, "click", 1)
    panel.run("result = 1")
    popup = iio.imread(panel.screenshot(tmp_path / "popup.png"))[..., :3].astype(int)
    # The name of the chosen lens stands in a blue bar; the one to its left is taken.
    blue = (popup[..., 2] > 150) & (popup[..., 2] - popup[..., 0] > 80)
    row = int(blue[: y - 110].sum(axis=1).argmax())
    columns = np.flatnonzero(blue[row])
    assert len(columns) > 60, "no popup"
    panel.xdotool("mousemove", columns.min() - 60, row - 40)
    panel.run("result = 1")
    panel.xdotool("click", 1)
    panel.wait_for("camera().aplanat.lens != 'tessar-50mm-f2.8'", timeout=20)
    assert panel.run("result = camera().aplanat.lens") in panel.run("result = library.ids()")
    # Framing is the artist's.
    assert panel.run("result = camera().lens") == 35
    panel.run("with bpy.context.temp_override(window=window()): bpy.ops.ed.undo()")
    assert panel.run("result = camera().aplanat.lens") == "tessar-50mm-f2.8"


def test_lenses_that_cannot_be_used_are_drawn_as_such(panel, tmp_path):
    panel.run(
        "folder = module('scene.camera.lenses').user_folder()\n"
        "folder.mkdir(parents=True, exist_ok=True)\n"
        "(folder / 'broken.toml').write_text('format = 1')\n"
        "bpy.ops.wm.aplanat_reload_lenses()"
    )
    assert "/.user/" in panel.run("result = str(folder)")
    for lens in ("broken", "no-such-lens", "anamorphic-60mm-f2", "zoom-36-69mm-f3.5"):
        panel.run(f"camera().aplanat.lens = {lens!r}; editor().tag_redraw()")
        panel.run("result = 1")
    panel.run("camera().type = 'ORTHO'; editor().tag_redraw()")
    panel.run("result = 1")
    panel.run("(folder / 'broken.toml').unlink(); bpy.ops.wm.aplanat_reload_lenses()")


def test_a_lens_file_is_opened_in_a_text_editor(panel):
    panel.run(
        "camera().aplanat.lens = 'tessar-50mm-f2.8'\n"
        "with bpy.context.temp_override(window=window(), area=editor()):\n"
        "    bpy.ops.camera.aplanat_edit_lens()"
    )
    assert panel.run("result = camera().aplanat.lens") == "tessar-50mm-f2.8-copy"
    assert panel.run(
        "result = [area.spaces.active.text.name for w in bpy.context.window_manager.windows"
        " for area in w.screen.areas if area.type == 'TEXT_EDITOR']"
    ) == ["tessar-50mm-f2.8-copy.toml"]
    panel.run(
        "with bpy.context.temp_override(window=window(), area=editor()):\n"
        "    bpy.ops.camera.aplanat_remove_lens()"
    )


def test_work_ends_with_the_file_the_extension_and_blender(panel):
    panel.wait_for("background.progress() is not None", timeout=30)
    panel.run("bpy.ops.wm.read_homefile(use_factory_startup=True, load_ui=False)")
    show_again(panel)
    panel.wait_for("background.progress() is not None", timeout=30)
    panel.run(
        "import addon_utils, threading\n"
        "addon_utils.disable(ADDON)\n"
        "result = [t.name for t in threading.enumerate()]",
        timeout=60,
    )
    assert panel.run(
        "result = not any(t.name == 'aplanat-background' for t in threading.enumerate())"
    )
    panel.run("addon_utils.enable(ADDON)")
    show_again(panel)
    panel.wait_for("background.progress() is not None", timeout=30)
    panel.run("bpy.app.timers.register(lambda: bpy.ops.wm.quit_blender(), first_interval=0.2)")
    assert panel.process.wait(60) == 0
