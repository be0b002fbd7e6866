"""The command line as a process of its own: its channels, its exit code, its death."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import OpenEXR
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]


def command(*words):
    return [sys.executable, "-P", "-m", "addon.cli", *map(str, words)]


def environment(**more):
    return os.environ | {"PYTHONPATH": str(REPOSITORY), "PYTHONDONTWRITEBYTECODE": "1"} | more


def run(*words, **more):
    return subprocess.run(
        command(*words), env=environment(**more), capture_output=True, text=True, timeout=300
    )


def test_stdout_is_one_object_and_messages_are_on_stderr(small_blend, tmp_path):
    done = run("render", small_blend, "-o", tmp_path / "a.exr", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["files"] == [str(tmp_path / "a.exr")]
    assert done.stdout.count("\n") == 1
    # Neither Blender's lines nor the driver's.
    assert all(line.startswith("aplanat: ") for line in done.stderr.splitlines()), done.stderr


def test_without_json_stdout_is_empty(small_blend, tmp_path):
    done = run("render", small_blend, "-o", tmp_path / "a.png")
    assert (done.returncode, done.stdout) == (0, "")
    assert "a.png" in done.stderr


def test_relative_names_start_where_the_caller_is(small_blend, tmp_path):
    done = subprocess.run(
        command("render", os.path.relpath(small_blend, tmp_path), "-o", "here.png"),
        env=environment(),
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "here.png").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="EGL is Linux' way to a GPU without a window")
@pytest.mark.parametrize(
    "switched_off",
    [
        {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent"},
        {"LIBGL_DRIVERS_PATH": "/nonexistent", "LIBGL_ALWAYS_SOFTWARE": "1"},
    ],
    ids=["no EGL vendor", "no driver"],
)
def test_no_gpu_is_refused_with_advice(small_blend, tmp_path, switched_off):
    done = run("render", small_blend, "-o", tmp_path / "a.png", **switched_off)
    assert done.returncode == 2, done
    assert done.stderr.count("\n") == 1 and "no GPU context" in done.stderr, done.stderr
    assert "install" in done.stderr
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
def test_killed_render_leaves_whole_files_or_none(small_blend, tmp_path, number):
    # Moments are random but fixed: some before the first file, some between two, some within one.
    moments = random.Random(number)
    for attempt in range(3):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        process = subprocess.Popen(
            command(
                *("render", small_blend, "-o", folder / "f_####.exr", "-o", folder / "f_####.png"),
                *("--frames", "1..5000", "--samples", "1", "--resolution", "400x300"),
            ),
            env=environment(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            wait_for_first_file(folder, process)
            time.sleep(moments.random())
            process.send_signal(number)
            assert process.wait(30) == -number
        finally:
            process.kill()
            process.wait()
        for path in folder.iterdir():
            assert path.suffix in {".exr", ".png"}, f"{path.name} was left behind"
            assert_whole(path)


def wait_for_first_file(folder, process):
    end = time.monotonic() + 120
    while not any(folder.iterdir()):
        assert process.poll() is None, "the render ended by itself"
        assert time.monotonic() < end, "no frame in two minutes"
        time.sleep(0.01)


def assert_whole(path):
    if path.suffix == ".png":
        # The last chunk of a PNG file.
        assert path.read_bytes()[-12:-4] == b"\x00\x00\x00\x00IEND", path
    else:
        with OpenEXR.File(str(path)) as file:
            assert file.parts[0].channels
