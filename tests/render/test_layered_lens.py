"""Layers seen through a real lens: the reference method's picture through the same lens."""

import numpy as np
import pytest

from benchmarks.scenes.capture_scene import add_plane
from tests.pictures import energy_ratio, save_side_by_side, ssim
from tests.render.test_adaptive import FOCUS, combined, passes, render, scene, surface_of

__all__ = ["scene"]

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

# Near enough for the opening of a lens of 50 mm.
NEAR = 0.1


@pytest.fixture
def seen(scene):
    """The balls of other tests a tenth as large and as far, through a strongly curved field."""
    scene.render.resolution_x, scene.render.resolution_y = 96, 54
    for thing in scene.objects:
        thing.location *= NEAR
        thing.scale *= NEAR
    data = scene.camera.data
    data.clip_start = 0.01
    data.dof.focus_distance, data.dof.aperture_fstop = NEAR * FOCUS, 1.4
    data.dof.aperture_blades = 0
    data.aplanat.lens, data.aplanat.exposure = "petzval-51mm-f1.4", "LENS"
    data.aplanat.bokeh.use = False
    return scene


def test_the_layered_picture_is_the_reference(seen, tmp_path):
    reference = combined(render(seen, "REFERENCE", 128))
    picture = combined(render(seen, "LAYERED", 64))
    save_side_by_side(tmp_path / "layered_reference.png", picture, reference)
    # Measured 0.996; a thin lens 0.93.
    assert ssim(picture, reference) > 0.99, tmp_path
    assert energy_ratio(picture, reference) == pytest.approx(1.0, abs=0.005), tmp_path
    assert picture[..., 3] == pytest.approx(np.ones((54, 96)), abs=1e-3)


def test_layers_that_are_no_slices_are_bent_too(seen, tmp_path):
    # A ray goes through all depths in one layer: there it is most of a curve.
    reference = combined(render(seen, "REFERENCE", 128))
    picture = combined(render(seen, "LAYERED", 64, layers=3, layer_source="PEELING"))
    save_side_by_side(tmp_path / "layered_reference.png", picture, reference)
    assert ssim(picture, reference) > 0.99, tmp_path


def test_skipping_layers_that_no_bent_ray_meets_changes_no_bit(seen, monkeypatch):
    from dataclasses import replace

    from addon.engine.planning import plan

    planned = plan.plan_layered
    culled = [combined(render(seen, "LAYERED", 4, layer_source=s)) for s in ("SLICES", "PEELING")]
    monkeypatch.setattr(plan, "plan_layered", lambda *a: replace(planned(*a), culls=False))
    whole = [combined(render(seen, "LAYERED", 4, layer_source=s)) for s in ("SLICES", "PEELING")]
    assert [p.tobytes() for p in culled] == [p.tobytes() for p in whole]


def test_what_is_even_stays_even_however_few_the_samples(seen, aplanat_bpy):
    # Neighbouring pixels see through other places on the lens: each is divided by its own light.
    add_plane(aplanat_bpy, "Wall", (0.0, 2.0, 0.0), 20.0, np.pi / 2, color=(0.5, 0.5, 0.5))
    for name in ("Near", "Focus", "Far"):
        seen.objects[name].hide_render = True
    data = seen.camera.data
    data.aplanat.exposure = "EVEN"
    # Stopped down a little: some of so few places are open everywhere in the picture.
    data.dof.aperture_fstop = 2.8
    layer = seen.view_layers[0]
    layer.use_pass_cryptomatte_object = layer.aplanat.use_pass_focus_matte = True
    found = passes(render(seen, "LAYERED", 16))
    assert found["Combined"][..., :3] == pytest.approx(np.full((54, 96, 3), 0.5), rel=3e-3)
    assert found["CryptoObject00"][..., 1] == pytest.approx(np.ones((54, 96)), abs=3e-3)
    # That one follows the lens' curved field, smoothly.
    matte = found["Focus Matte"][..., 0]
    assert max(np.abs(np.diff(matte, axis=axis)).max() for axis in (0, 1)) < 5e-3


def test_transparent_surfaces_are_seen_through_the_places_that_weigh_them(seen, tmp_path):
    tree = surface_of(seen.objects["Near"])
    clear = tree.node("BsdfTransparent").outputs[0]
    shine = tree.node("Emission", {"Color": (1.0, 0.5, 0.1), "Strength": 2.0}).outputs[0]
    both = tree.node("MixShader", {"Fac": 0.5, "Shader": clear, "Shader_001": shine})
    tree.tree.links.new(both.outputs[0], tree.output.inputs[0])
    reference = combined(render(seen, "REFERENCE", 128))
    picture = combined(render(seen, "LAYERED", 128))
    save_side_by_side(tmp_path / "layered_reference.png", picture, reference)
    assert ssim(picture, reference) > 0.97, tmp_path
    assert energy_ratio(picture, reference) == pytest.approx(1.0, abs=0.01), tmp_path
