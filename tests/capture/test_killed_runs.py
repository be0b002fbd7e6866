"""Runs that are killed, or have no room left: whole files or none, and the next run goes on."""

import sys
import tempfile
from contextlib import contextmanager

import pytest

from addon.cli.command import main
from benchmarks.scenes.capture_scene import build
from benchmarks.tools.killed_runs import killed_once, save_shot, start_and_kill

FRAMES = 3
FEW = ("--layers", "2", "--overscan", "0")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals and limits of POSIX")


@pytest.fixture(scope="module")
def shot(aplanat_bpy, tmp_path_factory):
    path = tmp_path_factory.mktemp("shot") / "shot.blend"
    save_shot(aplanat_bpy, build(aplanat_bpy), path, FRAMES)
    return path


@pytest.fixture(scope="module")
def captured(shot, tmp_path_factory):
    """The files of a capture that nobody stopped, in this process."""
    folder = tmp_path_factory.mktemp("captured")
    assert main(capture(shot, folder)) == 0
    return folder


def capture(shot, folder):
    return ["capture", str(shot), *FEW, "--frames", f"1..{FRAMES}", "-o", f"{folder}/l_#.exr"]


@contextmanager
def no_more_than(most):
    """In the `with` block files may only have so many bytes, as on a full disk."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.slow
def test_a_capture_that_is_killed_twice_goes_on_where_it_stopped(shot, captured, tmp_path):
    truth = {path.name: path.read_bytes() for path in captured.iterdir()}
    assert len(truth) == FRAMES
    start_and_kill(capture(shot, tmp_path), tmp_path, 0.05, after=1)
    trial = killed_once(capture(shot, tmp_path), tmp_path, truth, 0.03, after=2)
    assert trial.finished >= 2
    assert (trial.broken, trial.redone, trial.different) == ([], [], [])


@pytest.mark.parametrize(
    ("command", "ending", "most"),
    [
        ("capture", "exr", 1500),
        # Enough for the picture of a slice, and not for all layers.
        ("capture", "exr", 6000),
        ("refocus", "exr", 1500),
        ("refocus", "png", 400),
        ("render", "exr", 1500),
        ("render", "png", 400),
    ],
)
def test_a_full_disk_is_one_line_and_leaves_nothing(
    shot, captured, tmp_path, monkeypatch, capfd, command, ending, most
):
    out, rooms = tmp_path / "out", tmp_path / "tmp"
    for folder in (out, rooms):
        folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(rooms))
    source = captured / "l_#.exr" if command == "refocus" else shot
    more = FEW if command == "capture" else ("--samples", "1")
    capfd.readouterr()
    with no_more_than(most):
        code = main([command, str(source), *more, "-o", f"{out}/f_#.{ending}"])
    told = capfd.readouterr().err
    assert code == 1, told
    assert told.count("\n") == 1 and "is the disk full?" in told, told
    assert not list(out.iterdir()) and not list(rooms.glob("aplanat-*"))
