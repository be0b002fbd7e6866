"""Bokeh and fringes of captured layers: against our own render of the same scene."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.refocus.camera_settings import camera_settings
from addon.engine.refocus.refocusing import refocus
from addon.engine.refocus.settings import f_stop_of
from addon.engine.shared_resources import listen
from benchmarks.scenes.capture_scene import add_plane
from tests.pictures import energy_ratio, save_side_by_side, ssim

SIZE = (96, 54)


@pytest.fixture
def lamps(aplanat_bpy, blocks):
    """Small lamps before the focus, behind it, and behind a card that hides them in part."""
    scene = blocks
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.engine = "APLANAT"
    scene.aplanat.pixel_filter, scene.render.filter_size = "BOX", 1.0
    scene.aplanat.use_target_error = False
    dof = scene.camera.data.dof
    dof.aperture_fstop, dof.aperture_blades, dof.aperture_rotation = 0.08, 5, 0.3
    for name, place, color in (
        ("Before", (0.55, 0.5, -3.5), (60.0, 30.0, 10.0)),
        ("Behind", (-1.5, 1.3, -13.0), (20.0, 18.0, 30.0)),
        ("Beside", (2.2, 0.2, -10.0), (30.0, 12.0, 8.0)),
    ):
        add_plane(aplanat_bpy, name, place, 0.012 * -place[2], color=color)
    return scene


def captured(capture, scene):
    scene.aplanat.render_samples = 64
    return capture(scene, layers=6, overscan=0.15)


def settings_of(stack, scene, samples=64):
    import bpy

    depsgraph = bpy.context.evaluated_depsgraph_get()
    found, problems = camera_settings(
        stack, depsgraph, scene.camera.evaluated_get(depsgraph), samples=samples
    )
    assert all("opens no wider" in line for line in problems)
    return found


def rendered(scene, samples=256):
    import bpy

    scene.aplanat.method, scene.aplanat.render_samples = "ADAPTIVE", samples
    scene.aplanat.subsamples = 0
    with listen(keep_pictures=True) as heard:
        bpy.ops.render.render(scene=scene.name)
    assert heard.error is None
    return heard.layers[0].passes["Combined"].pixels


def check(tmp_path, picture, reference, least_ssim, energy=0.005):
    save_side_by_side(tmp_path / "refocused_rendered.png", picture[::-1], reference[::-1])
    assert np.isfinite(picture).all()
    assert ssim(picture, reference) > least_ssim, tmp_path
    assert energy_ratio(picture, reference) == pytest.approx(1.0, abs=energy), tmp_path


def test_highlights_before_and_behind_an_occluder(capture, lamps, tmp_path):
    stack = captured(capture, lamps)
    settings = settings_of(stack, lamps)
    assert settings.bokeh is not None and settings.iris.blades == 5
    reference = rendered(lamps)
    check(tmp_path, refocus(stack, settings), reference, 0.985)
    # Without bokeh the discs are as many dots as there are lens samples.
    dots = refocus(stack, replace(settings, bokeh=None, samples=16))
    assert ssim(refocus(stack, replace(settings, samples=16)), reference) > ssim(dots, reference)


def test_fringes_of_layers_and_of_their_highlights(capture, lamps, tmp_path):
    chromatic = lamps.camera.data.aplanat.chromatic
    chromatic.use, chromatic.axial, chromatic.lateral = True, 0.3, 0.6
    stack = captured(capture, lamps)
    settings = settings_of(stack, lamps, samples=256)
    assert settings.chromatic.focal_length == pytest.approx(0.05)
    reference = rendered(lamps, samples=512)
    picture = refocus(stack, settings)
    check(tmp_path, picture, reference, 0.985)
    # It is another picture without.
    plain = refocus(stack, replace(settings, chromatic=None))
    assert ssim(plain, reference) < ssim(picture, reference) - 0.01


def test_discs_of_a_real_lens(capture, lamps, tmp_path):
    # Near enough for the opening of a lens of 50 mm.
    lamps.camera.data.dof.focus_distance = 0.2
    lamps.camera.data.aplanat.lens = "double-gauss-50mm-f2"
    stack = captured(capture, lamps)
    assert stack.camera.lens_settings["lens"] == "double-gauss-50mm-f2"
    assert stack.camera.sensor_mm == pytest.approx((36.0, 36.0 * SIZE[1] / SIZE[0]))
    settings = settings_of(stack, lamps)
    reference = rendered(lamps, samples=128)
    picture = refocus(stack, settings)
    # Samples and discs are the same lens. Measured 0.993.
    check(tmp_path, picture, reference, 0.985)
    thin = refocus(stack, replace(settings, real_lens=None, f_stop=f_stop_of(stack, settings)))
    assert ssim(thin, reference) < ssim(picture, reference)
