"""What a farm relies on: frames are claimed, and warnings stop a strict render."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


def contents(folder):
    """Return the sizes of the files of a folder, by their names."""
    return {path.name: path.stat().st_size for path in sorted(folder.iterdir())}


@pytest.fixture
def during_frames(aplanat_bpy):
    """Call a function with the frame's number whenever Blender begins to render one."""
    added = []

    def listen(function):
        @aplanat_bpy.app.handlers.persistent
        def handler(scene, *_):
            function(aplanat_bpy.context.scene.frame_current)

        added.append(handler)
        aplanat_bpy.app.handlers.render_pre.append(handler)

    yield listen
    for handler in added:
        aplanat_bpy.app.handlers.render_pre.remove(handler)


def writing_to(folder, overwrite=False, placeholder=True, change=None):
    def prepare(bpy, scene):
        render = scene.render
        render.filepath = f"{folder}/shot_"
        render.use_overwrite, render.use_placeholder = overwrite, placeholder
        if change:
            change(bpy, scene)

    return prepare


@pytest.mark.parametrize("named", [False, True], ids=["scene's output", "-o"])
def test_frames_are_claimed_by_empty_files_and_claimed_frames_left(
    aplanat, make_blend, tmp_path, during_frames, named
):
    seen = {}
    during_frames(lambda frame: seen.setdefault(frame, contents(tmp_path)))
    (tmp_path / "shot_0002.png").touch()
    blend = make_blend(writing_to(tmp_path))
    output = ("-o", tmp_path / "shot_####.png") if named else ()
    done = aplanat("render", blend, *output, "--frames", "1..3", "--json")
    assert done.code == 0, done.err
    assert [frame["frame"] for frame in done.answer["frames"]] == [1, 3]
    assert seen[1] == {"shot_0001.png": 0, "shot_0002.png": 0}
    assert seen[3]["shot_0003.png"] == 0
    sizes = contents(tmp_path)
    assert sizes.keys() == {"shot_0001.png", "shot_0002.png", "shot_0003.png"}
    assert sizes["shot_0002.png"] == 0 and sizes["shot_0003.png"] > 0


def test_without_placeholders_nothing_is_claimed(aplanat, make_blend, tmp_path, during_frames):
    seen = {}
    during_frames(lambda frame: seen.setdefault(frame, contents(tmp_path)))
    blend = make_blend(writing_to(tmp_path, placeholder=False))
    assert aplanat("render", blend, "--frame", "1").code == 0
    assert seen == {1: {}}
    assert contents(tmp_path)["shot_0001.png"] > 0


def test_placeholders_with_overwrite_leave_what_is_there_until_it_is_replaced(
    aplanat, make_blend, tmp_path, during_frames
):
    seen = {}
    during_frames(lambda frame: seen.setdefault(frame, contents(tmp_path)))
    (tmp_path / "shot_0001.png").write_text("old")
    blend = make_blend(writing_to(tmp_path, overwrite=True))
    assert aplanat("render", blend, "--frames", "1..2").code == 0
    assert seen[1] == {"shot_0001.png": 3}
    assert seen[2]["shot_0002.png"] == 0
    assert min(contents(tmp_path).values()) > 10


def test_every_view_of_a_frame_is_claimed(aplanat, make_blend, tmp_path, during_frames):
    seen = {}
    during_frames(lambda frame: seen.setdefault(frame, contents(tmp_path)))

    def change(_bpy, scene):
        scene.render.use_multiview = True
        scene.render.image_settings.views_format = "INDIVIDUAL"

    # One view of a frame that exists is enough, as in Blender.
    (tmp_path / "shot_0002_R.png").touch()
    blend = make_blend(writing_to(tmp_path, change=change))
    assert aplanat("render", blend, "--frames", "1..2").code == 0
    assert seen == {1: {"shot_0001_L.png": 0, "shot_0001_R.png": 0, "shot_0002_R.png": 0}}
    assert contents(tmp_path).keys() == {"shot_0001_L.png", "shot_0001_R.png", "shot_0002_R.png"}


def test_a_frame_that_fails_gives_its_claim_back(aplanat, make_blend, tmp_path):
    def fail_in_frame_2(bpy, scene):
        broken = bpy.data.objects.new("Broken", bpy.data.cameras.new("Broken"))
        broken.data.type = "PANO"
        scene.collection.objects.link(broken)
        scene.timeline_markers.new("first", frame=1).camera = scene.camera
        scene.timeline_markers.new("then", frame=2).camera = broken

    blend = make_blend(writing_to(tmp_path, change=fail_in_frame_2))
    done = aplanat("render", blend, "--frames", "1..3")
    assert done.code == 2 and "pano" in done.err
    assert contents(tmp_path).keys() == {"shot_0001.png"}


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_render_that_is_ended_gives_its_claim_back(make_blend, tmp_path):
    output, held = tmp_path / "out", tmp_path / "held"
    output.mkdir()
    held.mkdir()

    def make_it_long(_bpy, scene):
        scene.aplanat.render_samples = 65536
        scene.render.resolution_x, scene.render.resolution_y = 640, 400

    blend = make_blend(writing_to(output, change=make_it_long))
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "addon.cli", "render", str(blend), "--frame", "1"],
        env=os.environ | {"PYTHONPATH": str(REPOSITORY), "TMPDIR": str(held)},
        stderr=subprocess.DEVNULL,
    )
    end = time.monotonic() + 120
    while not contents(output) and time.monotonic() < end:
        assert process.poll() is None
        time.sleep(0.05)
    assert contents(output) == {"shot_0001.png": 0}
    assert list(held.glob("aplanat-*"))
    process.send_signal(signal.SIGTERM)
    assert process.wait(30) == -signal.SIGTERM
    assert contents(output) == {}
    assert not list(held.glob("aplanat-*"))


def warn_in(frames):
    """Show a shadow catcher, which is drawn as any other surface, in some of the frames."""

    def change(_bpy, scene):
        catcher = scene.objects["Far"]
        catcher.is_shadow_catcher = True
        for frame in (1, 2, 3):
            catcher.hide_render = frame not in frames
            catcher.keyframe_insert("hide_render", frame=frame)

    return change


def test_strict_refuses_warnings_before_anything_is_drawn(
    aplanat, make_blend, tmp_path, during_frames
):
    frames = []
    during_frames(frames.append)
    blend = make_blend(writing_to(tmp_path, change=warn_in({1})))
    words = ("render", blend, "--frame", "1", "--stats", tmp_path / "stats.json", "--json")
    done = aplanat(*words, "--strict")
    assert done.code == 2
    assert "--strict" in done.err and "Traceback" not in done.err
    (error,) = done.answer["errors"]
    assert error["code"] == "strict" and "shadow catcher" in error["message"]
    (warning,) = done.answer["warnings"]
    assert warning.startswith("object 'Far': a shadow catcher")
    assert contents(tmp_path) == {}

    done = aplanat(*words)
    assert done.code == 0 and done.answer["warnings"] == [warning]
    assert json.loads((tmp_path / "stats.json").read_text())["warnings"] == [warning]
    assert "shot_0001.png" in contents(tmp_path)


def test_strict_holds_the_files_of_all_frames_back(aplanat, make_blend, tmp_path, during_frames):
    seen = {}
    during_frames(lambda frame: seen.setdefault(frame, contents(tmp_path)))
    blend = make_blend(writing_to(tmp_path, placeholder=False, change=warn_in({3})))
    done = aplanat("render", blend, "--frames", "1..3", "--strict")
    assert done.code == 2 and "shadow catcher" in done.err
    assert seen == {1: {}, 2: {}, 3: {}}
    assert contents(tmp_path) == {}
    done = aplanat("render", blend, "--frames", "1..2", "--strict", "--json")
    assert done.code == 0 and done.answer["warnings"] == []
    assert [Path(path).name for path in done.answer["files"]] == ["shot_0001.png", "shot_0002.png"]
    assert min(contents(tmp_path).values()) > 0


def test_strict_holds_files_back_from_what_only_the_drawing_finds(
    aplanat, make_blend, tmp_path, monkeypatch
):
    from addon.engine.frame.pipeline import FrameRenderer

    monkeypatch.setattr(FrameRenderer, "report", property(lambda self: ("lights merged",)))
    blend = make_blend(writing_to(tmp_path))
    done = aplanat("render", blend, "--frame", "1", "--strict", "--json")
    assert done.code == 2
    assert done.answer["warnings"] == ["lights merged"]
    assert contents(tmp_path) == {}
    done = aplanat("render", blend, "--frame", "1", "--json")
    assert done.code == 0 and done.answer["warnings"] == ["lights merged"]


def test_strict_takes_the_commands_own_warnings_too(aplanat, make_blend, tmp_path):
    def add_strip(_bpy, scene):
        editor = scene.sequence_editor_create()
        editor.strips.new_effect("Color", "COLOR", channel=1, frame_start=1, length=10)
        scene.render.use_sequencer = True

    blend = make_blend(add_strip)
    done = aplanat("render", blend, "-o", tmp_path / "a.png", "--strict")
    assert done.code == 2 and "sequencer" in done.err
    assert contents(tmp_path) == {}


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
@pytest.mark.parametrize("mask", [0o022, 0o027, 0o000])
def test_every_output_has_the_permissions_of_the_umask(aplanat, make_blend, tmp_path, mask):
    from tests.cli.test_animation_files import one_node

    scene_folder = tmp_path / "scene"

    def change(bpy, scene):
        scene.render.filepath = f"{scene_folder}/shot_"
        one_node(bpy, scene)
        scene.compositing_node_group.nodes["File Output"].directory = f"{tmp_path}/nodes/"

    blend = make_blend(change)
    lens = "double-gauss-50mm-f2"
    shipped = REPOSITORY / "lens_profiles" / f"{lens}.toml"
    before = os.umask(mask)
    try:
        words = ("--stats", tmp_path / "stats.json")
        outputs = ("-o", tmp_path / "a.exr", "-o", tmp_path / "a.png")
        assert aplanat("render", blend, *outputs, *words).code == 0
        assert aplanat("render", blend).code == 0
        assert aplanat("lens", "plot", lens, "-o", tmp_path / "plot.svg").code == 0
        assert aplanat("lens", "import", shipped, "-o", tmp_path / "lens.toml").code in {0, 2}
    finally:
        os.umask(before)
    found = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert {path.suffix for path in found} >= {".exr", ".png", ".json", ".svg"}
    for path in found:
        assert path.stat().st_mode & 0o777 == 0o666 & ~mask, path
    for folder in (scene_folder, tmp_path / "nodes"):
        assert folder.stat().st_mode & 0o777 == 0o777 & ~mask
