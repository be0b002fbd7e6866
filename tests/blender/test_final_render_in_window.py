"""F12 in Blender's window: it progresses, answers, stops on Esc, and leaves Blender usable."""

import time
from pathlib import Path

import imageio.v3 as iio
import pytest

STAGE = Path(__file__).with_name("stage.py").read_text()

WATCH = """
import time
import numpy as np
ticks, progress = [], []
def tick():
    ticks.append(time.monotonic())
    return 0.01
bpy.app.timers.register(tick, persistent=True)
listen = module("engine.shared_resources").listen
def note(share, text):
    progress.append(share)
def long_render(samples, **options):
    ticks.clear(); progress.clear()
    bpy.context.scene.aplanat.method = "REFERENCE"
    bpy.context.scene.aplanat.render_samples = samples
    start_render(**options)
"""


@pytest.fixture(scope="module")
def opened(blender, display, tmp_path_factory):
    with blender.window(display, folder=tmp_path_factory.mktemp("final")) as window:
        window.run(STAGE + WATCH)
        yield window


@pytest.fixture
def stage(opened):
    opened.run("build()")
    yield opened
    log = opened.log.read_text()
    assert "Traceback" not in log, log


def test_progress_moves_and_the_window_answers(stage):
    stage.run("listening = listen(progress=note); heard = listening.__enter__()")
    stage.run("long_render(400)")
    stage.wait_for("'render_complete' in events", timeout=200)
    error, cancelled, samples, shares, gaps = stage.run(
        "listening.__exit__(None, None, None)\n"
        "gaps = sorted(b - a for a, b in zip(ticks, ticks[1:]))\n"
        "samples = heard.statistics.lens_samples\n"
        "result = [str(heard.error), heard.cancelled, samples, progress, gaps]"
    )
    assert (error, cancelled, samples) == ("None", False, 400)
    assert shares == sorted(shares)
    assert len(shares) > 5 and shares[-1] == 1.0
    # A slice takes 50 ms, and the window's redraw about as long on a software device.
    assert gaps[len(gaps) // 2] < 0.3


def test_escape_cancels_within_a_second(stage):
    for _ in range(2):
        stage.run("long_render(60000)")
        stage.wait_for("len(ticks) > 20")
        stage.xdotool("mousemove", 300, 600)
        stage.xdotool("key", "Escape")
        start = time.monotonic()
        stage.wait_for("'render_cancel' in events", timeout=20)
        # A second for the engine; the rest is for pressing the key and asking.
        assert time.monotonic() - start < 2.0
    stage.run("long_render(8)")
    stage.wait_for("'render_complete' in events")


def test_same_picture_from_job_and_from_script(stage, tmp_path):
    files = [str(tmp_path / name) for name in ("job.png", "script.png")]
    stage.run("long_render(16)")
    stage.wait_for("'render_complete' in events")
    stage.run(f"bpy.data.images['Render Result'].save_render({files[0]!r})")
    stage.run(
        "bpy.ops.render.render()\n"
        f"bpy.data.images['Render Result'].save_render({files[1]!r})\n"
        "pixels = []\n"
        f"for name in {files!r}:\n"
        "    image = bpy.data.images.load(name)\n"
        "    pixels.append(np.array(image.pixels[:]))\n"
        "    bpy.data.images.remove(image)\n"
    )
    same, deviation = stage.run(
        "result = [bool((pixels[0] == pixels[1]).all()), float(pixels[0].std())]"
    )
    assert same
    assert deviation > 0.05


def test_error_is_told_and_the_next_render_works(stage):
    stage.run(
        "bpy.context.scene.camera.data.type = 'PANO'\n"
        "listening = listen(); heard = listening.__enter__()\n"
        # The job may report before the operator returns, which then raises.
        "try:\n    long_render(8)\nexcept RuntimeError as error:\n    print(error)"
    )
    stage.wait_for("'render_complete' in events or 'render_cancel' in events")
    error = stage.run("listening.__exit__(None, None, None); result = str(heard.error)")
    assert "is pano" in error and "\n" not in error
    stage.run("bpy.context.scene.camera.data.type = 'PERSP'; long_render(8)")
    stage.wait_for("'render_complete' in events")


def test_animation_with_two_view_layers_leaves_nothing(stage, tmp_path):
    alive = stage.run(
        f"""
        scene = bpy.context.scene
        scene.render.filepath = {str(tmp_path / "frame_####")!r}
        scene.frame_start, scene.frame_end = 1, 3
        scene.view_layers.new("second")
        counting = module("device.census").taken()
        counted = counting.__enter__()
        long_render(4, animation=True)
        """
    )
    stage.wait_for("'render_complete' in events", timeout=100)
    alive = stage.run("result = counted.alive(); counting.__exit__(None, None, None)")
    # The full-screen triangle and the like may stay; what belongs to a frame may not.
    assert sum(size for _, size in alive.values()) < 1_000_000, alive
    assert len(list(tmp_path.glob("frame_*.png"))) == 3
    stage.run("bpy.context.scene.view_layers.remove(bpy.context.scene.view_layers['second'])")


def test_render_while_the_viewport_is_rendered(stage):
    stage.run("viewports.clear(); view(); long_render(60)")
    stage.wait_for("'render_complete' in events and converged()", timeout=100)


def test_both_eyes_of_a_stereoscopic_render_show_the_scene(stage, tmp_path):
    stage.run(
        "render = bpy.context.scene.render\n"
        "render.use_multiview, render.views_format = True, 'STEREO_3D'\n"
        "render.image_settings.views_format = 'INDIVIDUAL'\n"
        "bpy.context.scene.frame_start = bpy.context.scene.frame_end = 1\n"
        f"render.filepath = {str(tmp_path / 'eye_')!r}\n"
        "bpy.context.scene.aplanat.render_samples = 4\n"
        "start_render(animation=True)"
    )
    try:
        stage.wait_for("'render_complete' in events", timeout=120)
        pictures = [iio.imread(tmp_path / f"eye_0001_{eye}.png") for eye in "LR"]
        assert all(picture[..., :3].max() > 50 for picture in pictures)
        assert (pictures[0] != pictures[1]).any()
    finally:
        stage.run("render.use_multiview = False")


def test_quitting_during_a_render_ends_blender(stage):
    stage.run("area().spaces.active.shading.type = 'SOLID'; long_render(60000)")
    stage.wait_for("len(ticks) > 20")
    stage.run("bpy.app.timers.register(bpy.ops.wm.quit_blender, first_interval=0.5)")
    stage.process.wait(timeout=20)
    assert stage.process.returncode == 0
