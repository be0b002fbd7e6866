"""A floor seen at a grazing angle goes through every cut: no light passes between the layers."""

import math

import numpy as np
import pytest

from addon.engine.refocus.refocusing import refocus
from addon.engine.refocus.settings import RefocusSettings
from benchmarks.scenes.capture_scene import add_plane, glowing
from tests.pictures import render_cycles, save_side_by_side, ssim
from tests.render.test_adaptive import combined, render

WIDTH, HEIGHT = 96, 54
FLOOR = 0.5


@pytest.fixture
def floor(empty_scene, aplanat_bpy):
    """A floor, a box on it and a card far behind it, in a black world that leaks would show."""
    bpy, scene = aplanat_bpy, empty_scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.world = bpy.data.worlds.new("Dark")
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    add_plane(bpy, "Floor", (0.0, 16.3, -0.5), 30.0, color=(FLOOR,) * 3)
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(-0.6, 3.0, -0.2))
    bpy.context.object.data.materials.append(glowing(bpy, "Box", (0.9, 0.1, 0.05)))
    add_plane(bpy, "Card", (1.3, 9.0, 0.2), 1.4, math.pi / 2, color=(0.05, 0.2, 0.9))
    data = bpy.data.cameras.new("Camera")
    scene.camera = bpy.data.objects.new("Camera", data)
    scene.collection.objects.link(scene.camera)
    scene.camera.rotation_euler = (math.radians(88.0), 0.0, 0.0)
    dof = data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 4.0, 0.25
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 16, False, False
    return scene


def floor_only(picture):
    """The part where no ray through the lens meets anything else."""
    return picture[:20, 45:70]


@pytest.mark.parametrize("engine", ["CYCLES", "APLANAT"])
def test_refocused_captures(capture, floor, tmp_path, engine):
    from addon.device.context import ensure_context

    ensure_context()
    floor.render.engine = engine
    floor.aplanat.render_samples = 16
    stack = capture(floor, layers=8, overscan=0.2)
    picture = refocus(stack, RefocusSettings(f_stop=0.25, samples=64))
    if engine == "CYCLES":
        expected = render_cycles(floor, 256)
    else:
        expected = combined(render(floor, "REFERENCE", 128))
    save_side_by_side(tmp_path / "refocused_expected.png", picture[::-1], expected)
    rows = [floor_only(p)[..., 0].mean(axis=1) for p in (picture, expected[::-1])]
    assert rows[1] == pytest.approx(np.full(20, FLOOR), rel=1e-3)
    assert rows[0] == pytest.approx(rows[1], rel=0.005)
    assert ssim(picture[::-1], expected) > 0.98, tmp_path


@pytest.mark.parametrize("engine", ["CYCLES", "APLANAT"])
def test_slices_thinner_than_a_row(capture, floor, engine):
    from addon.device.context import ensure_context

    ensure_context()
    for name in ("Cube", "Card"):
        floor.objects[name].hide_render = True
    floor.render.engine = engine
    floor.aplanat.render_samples = 16
    floor.render.resolution_x = 48
    # Some 27 rows of floor between the nearest and the horizon.
    stack = capture(floor, layers=20, overscan=0.2)
    for f_stop in (8.0, 0.25):
        picture = refocus(stack, RefocusSettings(f_stop=f_stop, samples=64))
        rows = picture[8:24, 16:32, 0].mean(axis=1)
        # Up to 40 % of a row's light was lost where each layer covers a part of it; what is left
        # is lost where two layers happen to cover equal parts, as edges of objects do.
        assert rows == pytest.approx(np.full(16, FLOOR), rel=0.02)


@pytest.mark.parametrize("shift", [0.0, 1.0, 2.0])
def test_a_horizon_lies_between_rows_of_texels(floor, shift):
    # A pixel has three rows of texels, which would have it up to a sixth too high or too low.
    floor.render.film_transparent = True
    floor.render.resolution_x = floor.render.resolution_y = 48
    for name in ("Cube", "Card"):
        floor.objects[name].hide_render = True
    data = floor.camera.data
    data.shift_y, data.dof.aperture_fstop = shift / 9.0 / 48.0, 8.0
    heights = []
    for method in ("LAYERED", "REFERENCE"):
        alpha = combined(render(floor, method, 128))[::-1, 16:32, 3]
        heights.append(alpha[16:].mean(axis=1).sum())
    # A third of a texel, half of it to either side, and the noise of the pixel's samples.
    assert heights[0] == pytest.approx(heights[1], abs=1.0 / 18.0 + 0.01)


def test_layers_of_our_own_engine(floor, tmp_path):
    reference = combined(render(floor, "REFERENCE", 128))
    # Many thin slices: their overlap is less than a texel of the floor.
    picture = combined(render(floor, "LAYERED", 64, layers=24))
    save_side_by_side(tmp_path / "layered_reference.png", picture, reference)
    rows = [floor_only(p[::-1])[..., 0].mean(axis=1) for p in (picture, reference)]
    assert rows[1] == pytest.approx(np.full(20, FLOOR), rel=1e-3)
    assert rows[0] == pytest.approx(rows[1], rel=0.005)
    assert ssim(picture, reference) > 0.98, tmp_path
