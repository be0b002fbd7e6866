"""A shot one of whose frames fails, and farms' jobs run on this machine."""

import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from benchmarks.scenes.small_scene import build_scene

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def failing_shot(aplanat_bpy, tmp_path_factory):
    """A .blend file whose camera is panoramic in frame 4, and which steps by 2 of its own."""
    bpy = aplanat_bpy
    scene = build_scene(bpy)
    scene.frame_step = 2
    panorama = scene.objects["Second"]
    panorama.data.type = "PANO"
    for frame, camera in ((1, scene.objects["Camera"]), (4, panorama), (5, scene.camera)):
        scene.timeline_markers.new("cut", frame=frame).camera = camera
    path = tmp_path_factory.mktemp("shots") / "failing shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


@pytest.fixture
def openjd():
    """Run a template of ours with openjd-cli; tells its code, and the lines of its session log."""

    def run(name, *words, **parameters):
        # As if it were Blender with Aplanat in it.
        parameters["Blender"] = REPOSITORY / "scripts" / "aplanat"
        given = [word for key, value in parameters.items() for word in ("-p", f"{key}={value}")]
        template = REPOSITORY / "farm" / "openjd" / f"{name}.yaml"
        done = subprocess.run(
            [sys.executable, "-m", "openjd", "run", str(template), *words, *given],
            capture_output=True,
            text=True,
            timeout=600,
        )
        # Each line begins with the time.
        lines = [re.sub(r"^\S+\t", "", line) for line in done.stdout.splitlines()]
        return SimpleNamespace(code=done.returncode, lines=lines, err=done.stderr)

    return run
