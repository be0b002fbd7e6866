"""Shadows are the same with every method, every order of frames, and with highlights split off."""

import numpy as np
import pytest

from benchmarks.scenes.pictures import render_picture
from tests.pictures import energy_ratio, render_aplanat, ssim
from tests.render.lights.shadow_scenes import shadow_scene

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def blurred(bpy, kind="AREA"):
    scene = shadow_scene(bpy, kind)
    dof = scene.camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 6.2, 0.3
    return scene


def render(scene, method, samples=None):
    settings = scene.aplanat
    scene.render.engine = "APLANAT"
    settings.method, settings.pixel_filter = method, "BOX"
    scene.render.filter_size = 1.0
    settings.use_target_error = samples is None
    if samples:
        settings.render_samples = samples
    return render_picture(scene)


@pytest.mark.parametrize(
    ("method", "samples", "least"),
    # Layers are lit from 32 places only.
    [("ADAPTIVE", None, 0.99), ("ADAPTIVE", 64, 0.99), ("LAYERED", 64, 0.98)],
)
def test_every_method_has_the_shadows_of_the_reference(aplanat_bpy, method, samples, least):
    reference = render_aplanat(blurred(aplanat_bpy), 256)
    ours = render(blurred(aplanat_bpy), method, samples)
    assert ssim(ours, reference) >= least
    assert energy_ratio(ours, reference) == pytest.approx(1.0, abs=0.003)


def test_a_glint_in_the_shadow_is_not_splatted(aplanat_bpy):
    """Light above the threshold: what is splatted and what is left are shadowed alike."""
    pictures = []
    for splats in (True, False):
        scene = blurred(aplanat_bpy)
        aplanat_bpy.data.lights["lamp"].energy = 2000.0
        scene.camera.data.dof.focus_distance = 2.5
        scene.camera.data.aplanat.bokeh.use = splats
        pictures.append(render(scene, "ADAPTIVE", 64))
    # Shadows of what is splatted come from 8 places.
    assert ssim(*pictures) >= 0.97
    assert energy_ratio(*pictures) == pytest.approx(1.0, abs=0.005)


def test_a_frame_is_the_same_whatever_was_rendered_before(aplanat_bpy):
    scene = blurred(aplanat_bpy)
    first = render(scene, "ADAPTIVE", 24)
    aplanat_bpy.data.objects["lamp"].location.x += 1.0
    render(scene, "ADAPTIVE", 24)
    aplanat_bpy.data.objects["lamp"].location.x -= 1.0
    assert np.array_equal(render(scene, "ADAPTIVE", 24), first)
