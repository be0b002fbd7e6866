"""Every pass on OpenGL and on Vulkan, from the same small scene in the real Blender."""

from pathlib import Path

import numpy as np
import pytest

from tests.pass_pictures import read_passes

REPO = Path(__file__).resolve().parents[2]

CODE = """
import sys

sys.path.insert(0, {repo!r})
import bpy
from tests.pass_pictures import build_scene, use_passes, write_passes

scene = bpy.data.scenes.new("Passes")
bpy.context.window.scene = scene
scene.render.resolution_x, scene.render.resolution_y = 96, 64
cube = build_scene(scene)["Cube"]
for frame in (1, 2, 3):
    cube.location.x += 0.1
    cube.keyframe_insert("location", frame=frame)
scene.frame_set(2)
layer = scene.view_layers[0]
use_passes(layer, "z", "normal", "position", "vector", "cryptomatte_object")
use_passes(layer, "cryptomatte_material")
layer.aplanat.use_pass_coc = layer.aplanat.use_pass_focus_matte = True
scene.render.engine = "APLANAT"
scene.aplanat.method = "REFERENCE"
scene.aplanat.render_samples = 48
write_passes(scene, {path!r})
"""

# Rounding of float32 in sizes of a few metres and pixels; Vulkan and OpenGL divide differently.
TOLERANCE = 1e-4


@pytest.fixture(scope="module")
def passes_by_backend(blender, tmp_path_factory):
    folder = tmp_path_factory.mktemp("backends")
    found = {}
    for backend in ("opengl", "vulkan"):
        path = folder / f"{backend}.exr"
        code = CODE.format(repo=str(REPO), path=str(path))
        blender.run_code(code, options=("--gpu-backend", backend))
        found[backend] = read_passes(path)[0]
    return found


def test_every_pass_agrees(passes_by_backend):
    opengl, vulkan = passes_by_backend["opengl"], passes_by_backend["vulkan"]
    assert opengl.keys() == vulkan.keys()
    assert len(opengl) == 13
    for name, picture in opengl.items():
        # A vertex on the border between two places of the rasteriser's grid may move an edge.
        differs = np.abs(picture - vulkan[name]).max(axis=-1) > TOLERANCE
        assert differs.mean() < 0.01, name
        assert np.abs(picture).max() > 0.0 or name.endswith(("01", "02")), name
