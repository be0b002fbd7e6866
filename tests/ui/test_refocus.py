"""Refocus: opening captures, what a scene asks for, the live picture, and writing."""

import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import OpenEXR
import pytest

from addon.engine.refocus.refocusing import Refocusing, refocus
from addon.engine.refocus.scene_refocus import as_sequence, flat_options, read_refocus
from addon.engine.refocus.settings import RefocusSettings
from addon.engine.shared_resources import resources
from addon.layers.layer_file import load_layers, save_layers
from addon.lens_io.lens_shelf import LensShelf
from addon.scene.camera.lens_record import record_lens
from addon.ui.jobs.live_refocus import LiveRefocus
from addon.ui.operators.restored_lens import restore_lens
from addon.ui.panels.bokeh_panel import APLANAT_CAMERA_PT_bokeh
from addon.ui.panels.lens_panel import APLANAT_CAMERA_PT_lens
from tests.engine.test_refocus import stack

__all__ = ["stack"]

HEADER = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}


@pytest.fixture
def scene(aplanat_bpy, empty_scene):
    yield empty_scene
    empty_scene.frame_set(1)


@pytest.fixture
def own(scene):
    return scene.aplanat.refocus


@pytest.fixture
def captured(stack, tmp_path):
    for frame in (1, 2, 3):
        save_layers(tmp_path / f"layers_{frame:04d}.exr", stack)
    return tmp_path / "layers_0001.exr"


@pytest.fixture
def open_file(aplanat_bpy, scene):
    return lambda path, **more: aplanat_bpy.ops.image.aplanat_refocus_open(
        filepath=str(path), **more
    )


def pixels_of(image):
    pixels = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)


def read_picture(path):
    with OpenEXR.File(str(path)) as found:
        return np.array(found.channels()["RGBA"].pixels)[::-1]


def wanted(scene, stack):
    depsgraph = scene.view_layers[0].depsgraph
    return read_refocus(scene, depsgraph, stack, resources().panels.sources)


def test_opening_takes_the_focus_of_the_capture(open_file, captured, own, stack):
    assert open_file(captured) == {"FINISHED"}
    assert own.path.endswith("layers_####.exr")
    assert (own.focus_distance, own.fstop) == (stack.camera.focus_distance, stack.camera.f_stop)
    assert tuple(own.image.size) == (stack.width, stack.height)
    assert own.image.is_float and own.image.alpha_mode == "PREMUL"


def test_a_file_of_another_frame_is_a_still(open_file, captured, own, tmp_path):
    assert open_file(tmp_path / "layers_0002.exr") == {"FINISHED"}
    assert own.path.endswith("layers_0002.exr")
    assert open_file(captured, use_sequence=False) == {"FINISHED"}
    assert own.path.endswith("layers_0001.exr")
    assert as_sequence(tmp_path / "layers_0002.exr").name == "layers_####.exr"
    captured.rename(tmp_path / "shot7_a.exr")
    assert as_sequence(tmp_path / "shot7_a.exr").name == "shot7_a.exr"


def test_what_cannot_be_opened_changes_nothing(aplanat_bpy, open_file, captured, own, tmp_path):
    whole = captured.read_bytes()
    (tmp_path / "broken.exr").write_bytes(whole[: len(whole) // 2])
    OpenEXR.File(dict(HEADER), {"RGBA": np.zeros((4, 4, 4), np.float32)}).write(
        str(tmp_path / "foreign.exr")
    )
    open_file(captured)
    before = own.path, own.image, own.focus_distance, len(aplanat_bpy.data.images)
    for name in ("broken.exr", "foreign.exr", "none.exr", "."):
        with pytest.raises(RuntimeError) as told:
            open_file(tmp_path / name)
        assert str(told.value).strip().count("\n") == 0 and str(tmp_path) in str(told.value)
    assert (own.path, own.image, own.focus_distance, len(aplanat_bpy.data.images)) == before


def test_a_picture_with_a_depth_pass(open_file, own, scene, camera, tmp_path):
    pixels = np.full((24, 32, 4), 0.5, np.float32)
    depth = np.linspace(0.0, 1.0, 24 * 32, dtype=np.float32).reshape(24, 32)
    path = tmp_path / "a.exr"
    OpenEXR.File(dict(HEADER), {"RGBA": pixels, "Depth.Z": depth}).write(str(path))
    with pytest.raises(RuntimeError, match="Depth Pass > Values: Normalized"):
        open_file(path)
    assert not own.path
    own.depth_values, own.depth_near, own.depth_far = "NORMALISED", 2.0, 6.0
    own.depth_channel = "Depth.Z"
    scene.camera.data.lens = 80.0
    assert flat_options(scene).focal_length_mm == 80.0
    assert open_file(path) == {"FINISHED"}
    assert own.focus_distance == pytest.approx(4.0, abs=0.1)


def test_camera_and_own_values(scene, own, camera, stack):
    data = scene.camera.data
    data.dof.focus_distance, data.dof.aperture_fstop, data.dof.aperture_blades = 6.0, 4.0, 5
    own.focus_distance, own.fstop, own.samples = 3.0, 0.5, 32
    settings, problems = wanted(scene, stack)
    assert not problems
    assert (settings.focus_distance, settings.f_stop) == (3.0, 0.5)
    assert (settings.iris.blades, settings.samples) == (5, 32)
    own.focus_from = own.fstop_from = "CAMERA"
    settings, _ = wanted(scene, stack)
    assert (settings.focus_distance, settings.f_stop) == (6.0, 4.0)
    own.use_camera_lens = False
    assert wanted(scene, stack)[0] == RefocusSettings(6.0, 4.0, samples=32)
    assert "ACEScg" in wanted(scene, replace(stack, color_space="ACEScg"))[1][0]
    scene.camera = None
    settings, problems = wanted(scene, stack)
    assert settings == RefocusSettings(samples=32) and "no camera" in problems[0]


def test_panels_of_the_camera_work_on_the_capture(scene, own, camera, stack):
    context = SimpleNamespace(engine="CYCLES", scene=scene, camera=scene.camera.data)
    data = scene.camera.data.aplanat
    assert not APLANAT_CAMERA_PT_bokeh.poll(context)
    own.path = "layers.exr"
    assert APLANAT_CAMERA_PT_bokeh.poll(context) and APLANAT_CAMERA_PT_lens.poll(context)
    data.bokeh.use, data.bokeh.gain = True, 3.0
    data.chromatic.use = True
    settings, _ = wanted(scene, stack)
    assert settings.bokeh.gain == 3.0 and settings.chromatic is not None
    # What does not change is the same: the picture goes on.
    assert settings == wanted(scene, stack)[0]
    data.lens = resources().lenses.ids()[0]
    assert wanted(scene, stack)[0].real_lens.id == data.lens
    assert wanted(scene, stack)[0] == wanted(scene, stack)[0]
    own.use_camera_lens = False
    assert not APLANAT_CAMERA_PT_bokeh.poll(context)
    assert wanted(scene, stack)[0].bokeh is None


def test_a_camera_gets_the_captured_lens_back(scene, own, camera, stack):
    data = scene.camera.data
    data.aplanat.lens, data.aplanat.bokeh.gain = resources().lenses.ids()[1], 4.0
    data.aplanat.bokeh.use = True
    told = replace(stack.camera, blades=7, lens_settings=record_lens(data))
    before = wanted(scene, stack)[0]
    data.aplanat.lens, data.aplanat.bokeh.gain, data.aplanat.bokeh.use = "", 1.0, False
    restore_lens(told, data)
    after = wanted(scene, stack)[0]
    assert (before.iris.blades, after.iris.blades) == (0, 7)
    assert after == replace(before, iris=after.iris, bokeh=after.bokeh)
    assert after.bokeh.gain == 4.0


def test_a_captured_lens_that_the_library_has_not_is_added_to_it(
    scene, own, camera, stack, tmp_path, monkeypatch
):
    from addon.engine.shared_resources import shelf
    from addon.lens_io.recorded_lens import text_of
    from addon.ui.operators import restored_lens

    class Shelf:
        """A library of one folder and of what was shipped, without the lens that was recorded."""

        def __init__(self):
            self.folder = LensShelf([tmp_path])

        def __call__(self):
            return self.folder

    monkeypatch.setattr(restored_lens, "shelf", Shelf())
    monkeypatch.setattr(restored_lens, "user_folder", lambda: tmp_path)
    data = scene.camera.data
    data.aplanat.lens = "tessar-50mm-f2.8"
    told = record_lens(data)
    # The same lens there: nothing is added.
    assert restore_lens(replace(stack.camera, lens_settings=told), data) is None
    text = text_of(shelf(), "petzval-51mm-f1.4")
    for name, wanted in (("my own", "my-own"), ("tessar-50mm-f2.8", "tessar-50mm-f2.8-2")):
        told = {**told, "lens": name, "lens_file": text}
        assert restore_lens(replace(stack.camera, lens_settings=told), data) == wanted
        assert data.aplanat.lens == wanted
        assert (tmp_path / f"{wanted}.toml").read_text() == text


def work_on(live, scene):
    depsgraph = scene.view_layers[0].depsgraph
    for _ in range(2000):
        if not live.work(scene, depsgraph) and not live.is_reading:
            return
        # The file is read by another thread.
        time.sleep(0.005 * live.is_reading)
    raise AssertionError("it does not end")


def test_the_live_picture_is_that_of_the_command(open_file, captured, own, scene, stack):
    open_file(captured)
    own.use_camera_lens, own.samples, own.focus_distance = False, 40, 2.0
    live = LiveRefocus(resources().panels)
    try:
        work_on(live, scene)
        assert live.finished and not live.error and live.share == 1.0
        settings = RefocusSettings(2.0, stack.camera.f_stop, samples=40)
        assert pixels_of(own.image).tobytes() == refocus(stack, settings).tobytes()
        # A change in the middle of a picture, and back.
        own.fstop = 2.0
        live.work(scene, scene.view_layers[0].depsgraph)
        own.fstop = stack.camera.f_stop
        own.focus_distance = 8.0
        work_on(live, scene)
        expected = refocus(stack, replace(settings, focus_distance=8.0))
        assert pixels_of(own.image).tobytes() == expected.tobytes()
        assert live.picture().tobytes() == expected.tobytes()
        # Whose pixels are lost, gets them back without sampling again.
        own.image.pixels.foreach_set(np.zeros(expected.size, np.float32))
        live.show_again()
        work_on(live, scene)
        assert pixels_of(own.image).tobytes() == expected.tobytes()
    finally:
        live.close()


def test_a_draft_of_the_bokeh_becomes_the_whole(open_file, captured, own, scene, camera, stack):
    # A highlight on the near card.
    stack.layers[0].color[24, 30, :3] = 50.0
    save_layers(captured, stack)
    open_file(captured)
    own.samples, own.focus_distance = 20, 0.6
    bokeh = scene.camera.data.aplanat.bokeh
    bokeh.use = True
    live = LiveRefocus(resources().panels)
    try:
        work_on(live, scene)
        settings = wanted(scene, stack)[0]
        expected = refocus(stack, settings)
        assert pixels_of(own.image).tobytes() == expected.tobytes()
        assert (refocus(stack, replace(settings, bokeh=None)) != expected).any()
        own.focus_distance = 0.5
        work_on(live, scene)
        expected = refocus(stack, wanted(scene, stack)[0])
        assert pixels_of(own.image).tobytes() == expected.tobytes()
    finally:
        live.close()


def test_the_live_picture_tells_what_is_wrong(
    open_file, captured, own, scene, tmp_path, monkeypatch, capsys
):
    open_file(captured)
    own.samples = 4
    live = LiveRefocus(resources().panels)
    try:
        work_on(live, scene)
        assert live.finished
        # A frame without a file, and back.
        scene.frame_set(9)
        work_on(live, scene)
        assert "layers_0009.exr" in live.error and live.stack is None
        scene.frame_set(2)
        while live.stack is None:
            assert "layers_0009.exr" in live.error
            live.work(scene, scene.view_layers[0].depsgraph)
        # A window may draw before anything is drawn here.
        assert not live.error and live.share is None
        work_on(live, scene)
        assert live.finished and not live.error
        # A defect of ours: told once, and gone with the settings that brought it.
        monkeypatch.setattr(Refocusing, "change", lambda *_: 1 / 0)
        own.fstop = 4.0
        for _ in range(3):
            work_on(live, scene)
            assert "division" in live.error
        assert capsys.readouterr().err.count("Traceback") == 1
        monkeypatch.undo()
        work_on(live, scene)
        assert live.error
        own.fstop = 2.0
        work_on(live, scene)
        assert live.finished and not live.error
        # Not ours any more.
        own.image.source = "FILE"
        own.fstop = 8.0
        work_on(live, scene)
        assert "no generated float image" in live.error
        (tmp_path / "layers_0003.exr").write_bytes(b"\x76\x2f\x31\x01 and no more")
        scene.frame_set(3)
        work_on(live, scene)
        assert "layers_0003.exr" in live.error and live.error.count("\n") == 0
    finally:
        live.close()


def test_keyframes_are_written(aplanat_bpy, open_file, captured, own, scene, stack, tmp_path):
    open_file(captured)
    scene.frame_start, scene.frame_end = 1, 3
    own.use_camera_lens, own.samples = False, 8
    for frame, focus in ((1, 2.0), (3, 8.0)):
        own.focus_distance = focus
        own.keyframe_insert("focus_distance", frame=frame)
    scene.frame_set(2)
    # Changed and not keyed: it stays.
    own.focus_distance = 33.0
    own.output = str(tmp_path / "out" / "picture_##.exr")
    assert aplanat_bpy.ops.image.aplanat_refocus_write(animation=True) == {"FINISHED"}
    assert (scene.frame_current, own.focus_distance) == (2, 33.0)
    found = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert found == ["picture_01.exr", "picture_02.exr", "picture_03.exr"]
    for frame, focus in ((1, 2.0), (3, 8.0)):
        settings = RefocusSettings(focus, own.fstop, samples=8)
        picture = read_picture(tmp_path / "out" / f"picture_0{frame}.exr")
        assert picture.tobytes() == refocus(stack, settings).tobytes()
    # The present frame alone is as it is now.
    own.output = str(tmp_path / "still.exr")
    assert aplanat_bpy.ops.image.aplanat_refocus_write() == {"FINISHED"}
    settings = RefocusSettings(33.0, own.fstop, samples=8)
    assert read_picture(tmp_path / "still.exr").tobytes() == refocus(stack, settings).tobytes()


def test_a_png_leaves_the_scene_as_it_is(aplanat_bpy, open_file, captured, own, scene, tmp_path):
    open_file(captured)
    own.samples, own.output = 4, str(tmp_path / "a.png")
    scene.render.image_settings.file_format = "JPEG"
    before = len(aplanat_bpy.data.scenes), len(aplanat_bpy.data.images)
    assert aplanat_bpy.ops.image.aplanat_refocus_write() == {"FINISHED"}
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    assert scene.render.image_settings.file_format == "JPEG"
    assert (len(aplanat_bpy.data.scenes), len(aplanat_bpy.data.images)) == before


@pytest.mark.parametrize(
    ("output", "last", "told"),
    [
        ("a.jpg", 1, "must end in .exr or .png"),
        ("a.exr", 2, "needs ####"),
        ("a_##.exr", 5, "layers_0004.exr"),
    ],
)
def test_what_cannot_be_written(
    aplanat_bpy, open_file, captured, own, scene, tmp_path, output, last, told
):
    open_file(captured)
    scene.frame_start, scene.frame_end = 1, last
    own.samples, own.output = 4, str(tmp_path / "new" / output)
    with pytest.raises(RuntimeError) as found:
        aplanat_bpy.ops.image.aplanat_refocus_write(animation=True)
    assert told in str(found.value) and str(found.value).strip().count("\n") == 0
    assert not list(tmp_path.glob("new/*")) and scene.frame_current == 1


def test_closing_removes_the_image(aplanat_bpy, open_file, captured, own):
    count = len(aplanat_bpy.data.images)
    open_file(captured)
    assert aplanat_bpy.ops.image.aplanat_refocus_close() == {"FINISHED"}
    assert (own.path, own.image, len(aplanat_bpy.data.images)) == ("", None, count)
    assert not aplanat_bpy.ops.image.aplanat_refocus_write.poll()
    assert load_layers(captured)
