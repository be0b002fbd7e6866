"""Refocus in Blender's window: a click sets the focus, the picture follows, nothing is left."""

from pathlib import Path

import imageio.v3 as iio
import numpy as np
import OpenEXR
import pytest

from addon.layers.layer_file import save_layers
from addon.layers.layer_stack import DepthLayer, LayerCamera, LayerStack

STAGE = Path(__file__).parents[1].joinpath("stage.py").read_text()
WIDTH, HEIGHT, ACROSS, UP = 160, 90, 16, 10
NEAR, FAR, FOCUS = 2.0, 8.0, 4.0

# Runs inside Blender.
EDITOR = """
import gc
live_refocus = module("ui.jobs.live_refocus")
shared_resources = module("engine.shared_resources")
census = module("device.census")

def editor():
    return max(window().screen.areas, key=lambda area: area.width * area.height)

# No other tab in the sidebar than ours.
for name in dir(bpy.types):
    cls = getattr(bpy.types, name)
    if getattr(cls, "bl_space_type", "") == "IMAGE_EDITOR" and "_PT_" in name:
        if getattr(cls, "bl_region_type", "") == "UI" and not name.startswith("APLANAT"):
            if cls.is_registered:
                bpy.utils.unregister_class(cls)

def region_of(kind="WINDOW"):
    return next(r for r in editor().regions if r.type == kind)

def in_editor():
    editor().type = "IMAGE_EDITOR"
    return bpy.context.temp_override(window=window(), area=editor(), region=region_of())

def own():
    return bpy.context.scene.aplanat.refocus

def open_layers(path):
    with in_editor():
        answer = list(bpy.ops.image.aplanat_refocus_open(filepath=path))
        editor().spaces.active.show_region_ui = True
        bpy.ops.wm.redraw_timer(type="DRAW", iterations=2)
        bpy.ops.image.view_all(fit_view=True)
        # Operators that scripts call are no steps of their own.
        bpy.ops.ed.undo_push(message="Open")
    return answer

def live():
    return live_refocus.live_of(bpy.context.scene)

def done():
    return live() is not None and live().finished

def picking():
    return [o.bl_idname for o in window().modal_operators] == ["IMAGE_OT_aplanat_refocus_pick"]

def pick():
    with in_editor():
        bpy.ops.image.aplanat_refocus_pick("INVOKE_DEFAULT")

def screen_place(x, y):
    region = region_of()
    across, up = region.view2d.view_to_region(x, y, clip=False)
    return [region.x + across, window().height - 1 - region.y - up]

def save_pixels(path):
    image = own().image
    found = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(found)
    np.save(path, found.reshape(image.size[1], image.size[0], 4))

def bytes_on_device():
    # Small things that refer to each other go when Python looks for them; the layers went before.
    gc.collect()
    return counted.alive().get("texture", (0, 0))[1]

def left():
    timers = bpy.app.timers.is_registered(live_refocus._work)
    return [len(shared_resources.resources().live), timers, len(window().modal_operators)]
"""


def card(depth, color, cover):
    pixels = np.where(cover[..., None], np.float32([*color, 1.0]), np.float32(0.0))
    return DepthLayer(pixels, np.where(cover, depth, np.inf).astype(np.float32))


@pytest.fixture(scope="module")
def layers(tmp_path_factory):
    """A near card on the left, a striped far one, and a world."""
    rows, columns = np.mgrid[0 : HEIGHT + 2 * UP, 0 : WIDTH + 2 * ACROSS]
    stripes = (0.6, 0.3, 0.1) * np.where((columns // 4 + rows // 4) % 2, 1.0, 0.2)[..., None]
    near = card(NEAR, (0.1, 0.5, 0.9), np.hypot(columns - 56, rows - 55) < 26)
    far = card(FAR, (0.0, 0.0, 0.0), abs(columns - 126) < 32)
    far.color[..., :3] = stripes * far.color[..., 3:]
    world = card(np.inf, (0.2, 0.25, 0.2), np.full(rows.shape, True))
    across = 2.0 * 50.0 / 36.0
    rows = ((across, 0, 0, 0), (0, across * WIDTH / HEIGHT, 0, 0), (0, 0, -1, -0.2), (0, 0, -1, 0))
    camera = LayerCamera(rows, f_stop=1.0, focus_distance=FOCUS, focal_length_mm=50.0)
    path = tmp_path_factory.mktemp("layers") / "layers_0001.exr"
    save_layers(path, LayerStack((near, far, world), camera, WIDTH, HEIGHT, (ACROSS, UP)))
    return path


@pytest.fixture(scope="module")
def opened(blender, display, tmp_path_factory):
    with blender.window(display, folder=tmp_path_factory.mktemp("refocus")) as window:
        window.run(STAGE + EDITOR)
        yield window


@pytest.fixture
def stage(opened, layers):
    opened.run("build(); own().use_camera_lens, own().samples = False, 64")
    assert opened.run(f"result = open_layers({str(layers)!r})") == ["FINISHED"]
    opened.wait_for("done()")
    yield opened
    log = opened.log.read_text()
    assert "Traceback" not in log, log


def click(window, x, y, button=1):
    """Click at a place of the picture, in shares of its width and height."""
    left, top = window.run(f"result = screen_place({x}, {y})")
    window.xdotool("mousemove", left, top)
    window.run("result = 1")
    window.xdotool("click", button)


def test_a_click_focuses_and_the_picture_is_that_of_the_command(stage, blender, layers, tmp_path):
    stage.run("with in_editor(): bpy.ops.image.view_zoom_ratio(ratio=3.0)")
    stage.run("pick()")
    stage.wait_for("picking()")
    # In the middle of the far card.
    click(stage, (126 - ACROSS) / WIDTH, 0.5)
    stage.wait_for("not window().modal_operators")
    assert stage.run("result = own().focus_distance") == FAR
    stage.wait_for("done()")
    stage.run(f"save_pixels({str(tmp_path / 'live.npy')!r})")
    words = ("--focus", FAR, "--samples", 64, "-o", tmp_path / "told.exr")
    blender.run("--command", "aplanat", "refocus", layers, *words)
    with OpenEXR.File(str(tmp_path / "told.exr")) as found:
        told = np.array(found.channels()["RGBA"].pixels)[::-1]
    assert np.array_equal(np.load(tmp_path / "live.npy"), told)
    # And on the screen: what is near is blurred now, what is far has its checks.
    shot = iio.imread(stage.screenshot(tmp_path / "shot.png"))
    assert shot.std() > 10
    # Undo takes the focus back, and the picture follows.
    stage.run("with in_editor(): bpy.ops.ed.undo()")
    assert stage.run("result = own().focus_distance") == FOCUS
    stage.wait_for("done()")
    stage.run(f"save_pixels({str(tmp_path / 'undone.npy')!r})")
    assert not np.array_equal(np.load(tmp_path / "undone.npy"), told)


@pytest.mark.parametrize("how", ["Escape", "right button", "the world"])
def test_picking_is_cancelled(stage, how):
    stage.run("pick()")
    stage.wait_for("picking()")
    if how == "Escape":
        stage.xdotool("key", how)
    else:
        # Left of both cards there is the world.
        click(stage, 0.02, 0.1, 1 if how == "the world" else 3)
    stage.wait_for("not window().modal_operators")
    assert stage.run("result = own().focus_distance") == FOCUS


def test_an_animation_is_written_and_escape_stops_it(stage, tmp_path):
    pattern = str(tmp_path / "out_##.exr")
    stage.run("s = bpy.context.scene; s.frame_start, s.frame_end = 1, 2")
    stage.run(f"own().output = {pattern!r}")
    write = "bpy.ops.image.aplanat_refocus_write('INVOKE_DEFAULT', animation=True)"
    begin = f"with in_editor(): {write}"
    stage.run(begin)
    stage.wait_for("not window().modal_operators and done()")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out_01.exr", "out_02.exr"]
    stage.run("own().samples = 10000")
    for path in tmp_path.iterdir():
        path.unlink()
    stage.run(begin)
    stage.xdotool("key", "Escape")
    stage.wait_for("not window().modal_operators")
    assert not list(tmp_path.iterdir())
    assert stage.run("result = bpy.context.scene.frame_current") == 1


def test_nothing_is_left_behind(stage, layers):
    stage.run("editor().type = 'VIEW_3D'")
    stage.wait_for("left() == [0, False, 0]")
    stage.run("taking = census.taken(); counted = taking.__enter__()")
    for leave in (
        "editor().type = 'VIEW_3D'",
        "bpy.data.images.remove(own().image)",
        "with in_editor(): bpy.ops.image.aplanat_refocus_close()",
    ):
        stage.run(f"open_layers({str(layers)!r})")
        stage.wait_for("done()")
        assert stage.run("result = bytes_on_device()") > 0
        stage.run(leave)
        stage.wait_for("left() == [0, False, 0]")
        assert stage.run("result = bytes_on_device()") == 0, leave
    # What another file brings.
    stage.run(f"open_layers({str(layers)!r})")
    stage.wait_for("done()")
    stage.run("live_refocus._end_all()")
    assert stage.run("result = bytes_on_device()") == 0
    stage.run("taking.__exit__(None, None, None)")


def test_a_file_that_is_opened_again_goes_on(stage, tmp_path):
    live, again = tmp_path / "live.npy", tmp_path / "again.npy"
    stage.run(f"save_pixels({str(live)!r})")
    stage.run(f"bpy.ops.wm.save_as_mainfile(filepath={str(tmp_path / 'shot.blend')!r})")
    stage.run(f"bpy.ops.wm.open_mainfile(filepath={str(tmp_path / 'shot.blend')!r})")
    stage.wait_for("done()")
    stage.run(f"save_pixels({str(again)!r})")
    assert np.array_equal(np.load(live), np.load(again))
