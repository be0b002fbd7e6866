"""The same frames on OpenGL and on Vulkan: every shader that they need compiles and agrees."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.pictures import ssim

REPO = Path(__file__).resolve().parents[2]
SIZE, SAMPLES = "320x180", 32


def combined(path):
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            channels = part.channels
            for name in channels:
                if name.endswith("Combined.R") or name == "R":
                    stem = name[:-1]
                    return np.stack([np.asarray(channels[stem + c].pixels) for c in "RGBA"], -1)
    raise AssertionError(f"no Combined pass in {path}")


def build(script, *arguments):
    done = subprocess.run(
        [sys.executable, script, *map(str, arguments)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="session")
def demo_blend(tmp_path_factory):
    path = tmp_path_factory.mktemp("demo") / "demo.blend"
    build(REPO / "scripts/demo_scene.py", "-o", path)
    return path


@pytest.fixture(scope="session")
def toys_blend(shared, tmp_path_factory):
    path = tmp_path_factory.mktemp("toys") / "toys.blend"
    script = shared / "scenes/build_scenes.py"
    build(script, "--scene", "toys", "--look", "flat", "--out", path)
    return path


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["demo", "toys"])
def test_vulkan_agrees_with_opengl(scene, blender, request, tmp_path):
    blend = request.getfixturevalue(f"{scene}_blend")
    pictures = {}
    for backend in ("opengl", "vulkan"):
        out = tmp_path / f"{backend}.exr"
        used = tmp_path / f"{backend}.txt"
        probe = f"import gpu; open({str(used)!r}, 'w').write(gpu.platform.backend_type_get())"
        blender.run("--gpu-backend", backend, "--python-expr", f"import gpu; gpu.init(); {probe}")
        assert used.read_text().lower() == backend
        done = blender.run(
            *("--gpu-backend", backend, "--command", "aplanat", "render", blend, "-o", out),
            *("--resolution", SIZE, "--samples", SAMPLES),
        )
        pictures[backend] = combined(out)
        assert pictures[backend].max() > 0.1, done.stdout + done.stderr
    # The arithmetic is the same: only rasterisation and rounding may differ.
    assert ssim(pictures["vulkan"], pictures["opengl"]) >= 0.999
