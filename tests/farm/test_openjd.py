"""The Open Job Description templates, run by openjd-cli."""

import shutil

import numpy as np
import OpenEXR
import pytest

FEW = "--samples 1 --resolution 16x12"


def ours(done):
    """The lines of a session log that the command wrote."""
    return [line for line in done.lines if line.startswith("aplanat: ")]


@pytest.mark.slow
def test_a_failing_frame_fails_its_task_with_our_line(openjd, failing_shot, tmp_path):
    folder = tmp_path / "made by the job"
    shot = {"SceneFile": failing_shot, "OutputFolder": folder, "Options": FEW}
    done = openjd("aplanat_shot", Frames="1-6", FramesPerTask=3, **shot)
    assert done.code == 1
    # Chunks are 1-3 and 4-6; the scene's own step skips none of a farm's frames.
    assert sorted(path.name for path in folder.iterdir()) == [
        f"frame_000{n}.exr" for n in (1, 2, 3)
    ]
    last = ours(done)[-1]
    assert last.startswith("aplanat: frame 4: camera 'Second' is pano"), done.lines
    assert "Traceback" not in "".join(done.lines)
    assert any("exited with code: 2" in line for line in done.lines), "\n".join(done.lines)
    # The farm goes on with what the failing frame is not in.
    done = openjd("aplanat_shot", "--tasks", '[{"Frame": "5-6"}]', Frames="1-6", **shot)
    assert done.code == 0, done.lines
    assert len(list(folder.iterdir())) == 5
    assert not [path for path in folder.iterdir() if path.suffix != ".exr"]


@pytest.mark.slow
def test_capture_and_refocus(openjd, failing_shot, tmp_path):
    layers, pictures = tmp_path / "layers", tmp_path / "pictures"
    words = "--engine APLANAT --layers 2 --overscan 0 --resolution 16x12"
    done = openjd(
        "aplanat_shot",
        Action="capture",
        SceneFile=failing_shot,
        Frames="1-3:2",
        FramesPerTask=2,
        OutputFolder=layers,
        OutputName="layers_####.exr",
        Options=words,
    )
    assert done.code == 0, done.lines
    assert sorted(path.name for path in layers.iterdir()) == ["layers_0001.exr", "layers_0003.exr"]
    cut = layers / "layers_0004.exr"
    shutil.copy(layers / "layers_0003.exr", cut)
    cut.write_bytes(cut.read_bytes()[:2000])
    job = {"LayersFolder": layers, "OutputFolder": pictures, "Options": "--samples 1 --fstop 8"}
    done = openjd("aplanat_refocus", Frames="3-4", **job)
    assert done.code == 1
    assert [path.name for path in pictures.iterdir()] == ["refocused_0003.exr"]
    last = ours(done)[-1]
    assert "layers_0004.exr' cannot be read" in last and "is it one, and whole?" in last
    with OpenEXR.File(str(pictures / "refocused_0003.exr")) as file:
        assert np.isfinite(file.parts[0].channels["RGBA"].pixels).all()
