"""`aplanat capture`: files of layers, a run that goes on, and what is refused."""

import os

import numpy as np
import pytest

from addon.errors import InputError
from addon.layers.layer_file import load_layers, load_words
from benchmarks.scenes.capture_scene import build

FEW = ("--layers", "2", "--overscan", "0")


@pytest.fixture(scope="module")
def shot(aplanat_bpy, tmp_path_factory):
    """A .blend file of four frames."""
    scene = build(aplanat_bpy)
    near = scene.objects["Near"]
    for frame, x in ((1, -0.6), (4, 0.6)):
        near.location.x = x
        near.keyframe_insert("location", frame=frame)
    scene.render.resolution_x, scene.render.resolution_y = 32, 18
    scene.cycles.samples = 1
    path = tmp_path_factory.mktemp("shot") / "shot.blend"
    aplanat_bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def test_frames_are_files_of_layers_with_metadata(aplanat, shot, tmp_path):
    out = tmp_path / "layers_####.exr"
    words = ("--frames", "1..4", "--frame-step", "3", "--json", "--stats", tmp_path / "s.json")
    done = aplanat("capture", shot, "-o", out, *FEW, *words)
    assert done.code == 0, done.err
    assert done.answer["files"] == [str(tmp_path / f"layers_000{n}.exr") for n in (1, 4)]
    one, four = (load_layers(path) for path in done.answer["files"])
    assert (one.frame, four.frame, one.engine) == (1, 4, "CYCLES")
    assert len(one.layers) == 3 and (one.width, one.height) == (32, 18)
    assert not np.array_equal(one.layers[0].color, four.layers[0].color)
    words = load_words(done.answer["files"][0])
    assert words["software"].startswith("Aplanat ") and words["colorSpace"] == one.color_space
    frame = done.answer["frames"][0]
    assert [render["what"] for render in frame["renders"]][0] == "measuring depths"
    assert len(frame["renders"]) == 4 and not frame["kept"]
    assert (tmp_path / "s.json").is_file()


def test_options_say_size_layers_and_precision(aplanat, shot, tmp_path):
    words = ("--resolution", "20x10", "--overscan", "0.5", "--layers", "3", "--half", "--frame", 2)
    done = aplanat("capture", shot, "-o", tmp_path / "a.exr", *words)
    assert done.code == 0, done.err
    stack = load_layers(tmp_path / "a.exr")
    assert (stack.width, stack.height, stack.overscan) == (20, 10, (10, 5))
    assert len(stack.layers) == 4 and stack.frame == 2
    color = stack.layers[0].color
    assert np.array_equal(color, color.astype(np.float16).astype(np.float32))


def test_our_own_engine_is_written_into_the_layers(aplanat, shot, tmp_path):
    done = aplanat("capture", shot, "-o", tmp_path / "a.exr", *FEW, "--engine", "APLANAT")
    assert done.code == 0, done.err
    assert load_layers(tmp_path / "a.exr").engine == "APLANAT"


def test_what_is_there_stays_and_what_is_broken_or_other_is_made_anew(aplanat, shot, tmp_path):
    out, words = tmp_path / "l_##.exr", ("--frames", "1..2")

    def kept(*more):
        done = aplanat("capture", shot, "-o", out, *FEW, *words, *more, "--json")
        assert done.code == 0, done.err
        return [frame["kept"] for frame in done.answer["frames"]]

    assert kept() == [False, False]
    before = [(tmp_path / f"l_0{n}.exr").read_bytes() for n in (1, 2)]
    stamp = os.stat(tmp_path / "l_01.exr").st_mtime_ns
    cut = tmp_path / "l_02.exr"
    cut.write_bytes(before[1][: len(before[1]) * 2 // 3])
    assert kept() == [True, False]
    assert os.stat(tmp_path / "l_01.exr").st_mtime_ns == stamp
    assert [(tmp_path / f"l_0{n}.exr").read_bytes() for n in (1, 2)] == before
    assert kept("--half") == [False, False]
    cut.write_bytes(b"something else")
    assert kept("--half") == [True, False]


def test_what_cannot_be_captured_is_refused_in_one_line(refused, shot, make_blend, tmp_path):
    out = ("-o", tmp_path / "a.exr")
    assert "does not exist" in refused("capture", tmp_path / "none.blend", *out)
    assert "does not exist" in refused("capture", shot, "-o", tmp_path / "no" / "a.exr")

    def workbench(_bpy, scene):
        scene.render.engine = "BLENDER_WORKBENCH"

    assert "BLENDER_WORKBENCH" in refused("capture", make_blend(workbench), *out)

    def no_camera(_bpy, scene):
        scene.camera = None

    assert "no camera" in refused("capture", make_blend(no_camera), *out)

    def panoramic(_bpy, scene):
        scene.camera.data.type = "PANO"

    assert "camera 'Camera' is pano" in refused("capture", make_blend(panoramic), *out)
    line = refused("capture", shot, *out, "--resolution", "40000x40000", "--overscan", "1")
    assert "120000 x 120000" in line


def test_strict_takes_what_is_missing_or_left_out_for_an_error(aplanat, make_blend, tmp_path):
    def lacking(bpy, scene):
        image = bpy.data.images.new("Lost", 4, 4)
        image.source, image.filepath = "FILE", "//nowhere.png"
        image.use_fake_user = True
        scene.render.use_border = True
        scene.cycles.samples = 1
        scene.render.engine = "CYCLES"

    path = make_blend(lacking)
    done = aplanat("capture", path, "-o", tmp_path / "a.exr", *FEW, "--strict", "--json")
    assert done.code == 2 and not (tmp_path / "a.exr").exists()
    assert "'Lost'" in done.answer["errors"][0]["message"]
    done = aplanat("capture", path, "-o", tmp_path / "a.exr", *FEW, "--json")
    assert done.code == 0, done.err
    assert any("render region" in line for line in done.answer["warnings"])


def test_a_full_disk_is_exit_code_1(aplanat, shot, tmp_path, monkeypatch):
    import OpenEXR

    def full(*_):
        raise RuntimeError("No space left on device")

    monkeypatch.setattr(OpenEXR.File, "write", full)
    done = aplanat("capture", shot, "-o", tmp_path / "a.exr", *FEW, "--json")
    assert done.code == 1 and "Traceback" not in done.err
    assert "No space left" in done.answer["errors"][0]["message"]
    assert not list(tmp_path.iterdir())
    monkeypatch.undo()
    with pytest.raises(InputError):
        load_layers(tmp_path / "a.exr")
