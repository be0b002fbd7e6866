"""Shadows of a lamp and of the sky on OpenGL and on Vulkan, in the real Blender."""

import numpy as np
import pytest

from tests.blender.test_backends import combined
from tests.render.lights.shadow_scenes import sky_scene


@pytest.fixture
def lit_blend(aplanat_bpy, tmp_path):
    """A room under a sky and a lamp."""
    bpy = aplanat_bpy
    scene = sky_scene(bpy, "image", 48)
    light = bpy.data.lights.new("lamp", "POINT")
    light.energy, light.shadow_soft_size = 100.0, 0.3
    lamp = bpy.data.objects.new("lamp", light)
    lamp.location = (0.2, -1.0, 1.5)
    scene.collection.objects.link(lamp)
    scene.render.engine = "APLANAT"
    path = tmp_path / "lit.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def test_shadows_agree(blender, lit_blend, tmp_path):
    pictures = []
    for backend in ("opengl", "vulkan"):
        out = tmp_path / f"{backend}.exr"
        blender.run(
            *("--gpu-backend", backend, "--command", "aplanat", "render", lit_blend, "-o", out),
            *("--method", "reference", "--samples", "16"),
        )
        pictures.append(combined(out)[..., :3])
    differs = np.abs(pictures[0] - pictures[1]).max(axis=-1) > 1e-3
    # A texel of a map at an edge may have one surface or the other; and edges of the picture.
    assert differs.mean() < 0.02
    assert np.isclose(pictures[0].mean(), pictures[1].mean(), rtol=1e-3)
