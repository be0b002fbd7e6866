"""Small scenes, and the command run in this process."""

import pytest

from benchmarks.scenes.small_scene import build_scene
from tests.cli.running import runner


@pytest.fixture(scope="session")
def make_blend(aplanat_bpy, tmp_path_factory):
    """Save a variation of the small scene: `make_blend(change)`, called with (bpy, scene)."""
    folder = tmp_path_factory.mktemp("blends")

    def make(change=None):
        scene = build_scene(aplanat_bpy)
        if change is not None:
            change(aplanat_bpy, scene)
        path = folder / f"{len(list(folder.iterdir()))}.blend"
        aplanat_bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
        return path

    return make


@pytest.fixture(scope="session")
def small_blend(make_blend):
    return make_blend()


@pytest.fixture
def aplanat(aplanat_bpy, capfd):
    """Run the command line in this process; tells code, out, err, and the answer of --json."""
    from addon.cli.command import main

    return runner(main, capfd)


@pytest.fixture
def refused(aplanat, tmp_path):
    """Run a command that must be refused: exit 2, one line, no file. Returns the line."""
    before = set(tmp_path.rglob("*"))

    def run(*words):
        done = aplanat(*words)
        assert done.code == 2, done
        assert done.out == ""
        assert done.err.startswith("aplanat: ")
        assert done.err.count("\n") == 1 and done.err.endswith("\n"), done.err
        assert "Traceback" not in done.err
        assert {p for p in tmp_path.rglob("*") if p.suffix != ".blend"} <= before
        return done.err

    return run


@pytest.fixture
def both(aplanat_bpy, aplanat, tmp_path):
    """Render the frames 1 to 3 of a scene both ways.

    Returns the files of Cycles' animation render, those of ours, each by its path within the folder
    of the .blend file, and our command's answer.
    """

    def run(change, *words):
        bpy = aplanat_bpy
        scene = build_scene(bpy)
        scene.render.filepath = "//frames/main_"
        change(bpy, scene)
        scene.frame_start, scene.frame_end = 1, 3
        scene.cycles.samples = 1
        folders = tmp_path / "cycles", tmp_path / "ours"
        for folder, engine in zip(folders, ("CYCLES", "APLANAT"), strict=True):
            folder.mkdir()
            scene.render.engine = engine
            bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"), copy=True)
        bpy.ops.wm.open_mainfile(filepath=str(folders[0] / "shot.blend"))
        bpy.ops.render.render(animation=True)
        words = words or ("--frames", "1..3")
        done = aplanat("render", folders[1] / "shot.blend", *words, "--json")
        assert done.code == 0, done.err
        found = [
            {p.relative_to(folder) for p in folder.rglob("*") if p.is_file()} for folder in folders
        ]
        return *(files - {folders[0] / "shot.blend"} for files in found), done.answer, folders[1]

    return run
