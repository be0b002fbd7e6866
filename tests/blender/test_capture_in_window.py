"""Capture Depth Layers in Blender's window: it goes on by itself, Esc stops it, the scene stays."""

from pathlib import Path

import pytest

from addon.layers.layer_file import load_layers

STAGE = Path(__file__).with_name("stage.py").read_text()

# Cycles' settings come with its add-on, which this Blender has switched on.
BEGIN = """
import time
def begin(engine, path, samples, **options):
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = samples, False
    scene.cycles.use_denoising = False
    scene.aplanat.render_samples = samples
    scene.aplanat.capture.layers, scene.aplanat.capture.path = 3, path
    with bpy.context.temp_override(window=window()):
        return list(bpy.ops.render.aplanat_capture_layers("INVOKE_DEFAULT", **options))
def at_rest():
    return len(bpy.data.scenes) == 1 and not bpy.app.is_job_running("RENDER")
def state():
    view = bpy.context.preferences.view
    names = [len(bpy.data.scenes), len(bpy.data.objects), len(bpy.data.cameras)]
    handlers = len(bpy.app.handlers.render_complete) + len(bpy.app.handlers.render_cancel)
    scene = bpy.context.scene
    return [*names, handlers, view.render_display_type, scene.render.film_transparent,
            scene.camera.name, scene.frame_current, len(window().modal_operators)]
"""


@pytest.fixture(scope="module")
def opened(blender, display, tmp_path_factory):
    with blender.window(display, folder=tmp_path_factory.mktemp("capture")) as window:
        window.run(STAGE + BEGIN)
        yield window


@pytest.fixture
def stage(opened):
    yield opened
    log = opened.log.read_text()
    assert "Traceback" not in log, log


@pytest.mark.parametrize("engine", ["CYCLES", "APLANAT"])
def test_a_capture_goes_on_by_itself_and_leaves_the_scene(engine, stage, tmp_path):
    path = tmp_path / "layers.exr"
    before = stage.run("build(); result = state()")
    assert stage.run(f"result = begin({engine!r}, {str(path)!r}, 4)") == ["RUNNING_MODAL"]
    stage.wait_for("at_rest()", timeout=120)
    assert stage.run("result = state()") == before
    stack = load_layers(path)
    assert stack.engine == engine and (stack.width, stack.height) == (160, 90)
    assert len(stack.layers) == 4 and stack.layers[0].color[..., 3].any()


def test_escape_stops_it_and_nothing_is_written(stage, tmp_path):
    path = tmp_path / "layers.exr"
    before = stage.run("build(); result = state()")
    stage.run(f"result = begin('CYCLES', {str(path)!r}, 60000)")
    stage.wait_for("bpy.app.is_job_running('RENDER')")
    stage.xdotool("mousemove", 300, 600)
    stage.xdotool("key", "Escape")
    stage.wait_for("at_rest()", timeout=60)
    assert stage.run("result = state()") == before
    assert not path.exists()
    # And it can be begun again.
    stage.run(f"result = begin('APLANAT', {str(path)!r}, 4)")
    stage.wait_for("at_rest()", timeout=120)
    assert len(load_layers(path).layers) == 4


def test_frames_of_an_animation(stage, tmp_path):
    stage.run("build(); s = bpy.context.scene; s.frame_start, s.frame_end = 1, 2")
    stage.run(f"begin('APLANAT', {str(tmp_path / 'l_##.exr')!r}, 2, animation=True)")
    stage.wait_for("at_rest() and not window().modal_operators", timeout=120)
    assert [load_layers(tmp_path / f"l_0{n}.exr").frame for n in (1, 2)] == [1, 2]
