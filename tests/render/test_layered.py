"""The layered method's final renders against the reference method's (methods 7)."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.scenes.capture_scene import add_plane
from tests.pictures import energy_ratio, save_side_by_side, ssim
from tests.render.test_adaptive import (
    FOCUS,
    HEIGHT,
    TRUTH,
    WIDTH,
    blob,
    combined,
    passes,
    render,
    scene,
    surface_of,
)

__all__ = ["scene"]

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


def check(scene, tmp_path, least_ssim, samples=64, energy=0.01, **settings):
    layered = render(scene, "LAYERED", samples, **settings)
    reference = combined(render(scene, "REFERENCE", TRUTH))
    picture = combined(layered)
    save_side_by_side(tmp_path / "layered_reference_difference.png", picture, reference)
    assert np.isfinite(picture).all()
    assert ssim(picture, reference) > least_ssim, tmp_path
    assert energy_ratio(picture, reference) == pytest.approx(1.0, abs=energy), tmp_path
    assert picture[..., 3].mean() == pytest.approx(reference[..., 3].mean(), abs=0.005), tmp_path
    return layered


def test_the_layered_picture_is_the_reference(scene, tmp_path):
    # The bar of the whole method, which the shared scenes are held to as well.
    work = check(scene, tmp_path, 0.97).statistics
    # Layers draw the scene twice each, colours and finer shapes, and so do two looks for depths,
    # whatever the number of samples.
    assert work.triangles_submitted <= (2 * 8 + 2) * work.triangles_full_detail / 64


def changed_plan(monkeypatch, **values):
    """Have the layers of every frame planned with other values."""
    from addon.engine.planning import plan

    planned = plan.plan_layered

    def plan_layered(*arguments):
        found = planned(*arguments)
        return found and replace(found, **values)

    monkeypatch.setattr(plan, "plan_layered", plan_layered)


def test_rays_as_thick_as_their_distance_are_better_than_thin_ones(scene, monkeypatch):
    reference = combined(render(scene, "REFERENCE", TRUTH))
    thick = ssim(combined(render(scene, "LAYERED", 16)), reference)
    changed_plan(monkeypatch, cell=0.0)
    assert thick > ssim(combined(render(scene, "LAYERED", 16)), reference)


def test_skipping_layers_that_no_ray_meets_changes_no_bit(scene, monkeypatch):
    culled = combined(render(scene, "LAYERED", 8))
    changed_plan(monkeypatch, culls=False)
    assert combined(render(scene, "LAYERED", 8)).tobytes() == culled.tobytes()


def test_a_frame_has_the_same_bits_twice(scene):
    first, second = (combined(render(scene, "LAYERED", 4)).tobytes() for _ in range(2))
    assert first == second


@pytest.mark.parametrize("focus", [0.4, 30.0])
def test_everything_before_or_behind_the_focus_is_the_reference(scene, tmp_path, focus):
    scene.camera.data.dof.focus_distance = focus
    scene.camera.data.dof.aperture_fstop = 0.5
    check(scene, tmp_path, 0.96)


def test_a_parallel_camera_is_the_reference(scene, tmp_path):
    scene.camera.data.type = "ORTHO"
    scene.camera.data.ortho_scale = 6.0
    scene.camera.data.dof.aperture_fstop = 0.3
    check(scene, tmp_path, 0.97)


def test_transparent_and_glowing_surfaces_are_the_reference(scene, tmp_path):
    tree = surface_of(scene.objects["Near"])
    clear = tree.node("BsdfTransparent").outputs[0]
    shine = tree.node("Emission", {"Color": (1.0, 0.5, 0.1), "Strength": 2.0}).outputs[0]
    both = tree.node("MixShader", {"Fac": 0.5, "Shader": clear, "Shader_001": shine})
    tree.tree.links.new(both.outputs[0], tree.output.inputs[0])
    check(scene, tmp_path, 0.96, energy=0.02)


def test_a_hole_and_nothing_round_the_scene_are_the_reference(scene, tmp_path):
    scene.render.film_transparent = True
    scene.objects["Near"].is_holdout = True
    check(scene, tmp_path, 0.96)


def test_mattes_and_geometry_come_with_it(scene):
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_cryptomatte_object = True
    layer.aplanat.use_pass_focus_matte = layer.aplanat.use_pass_coc = True
    layered, reference = (passes(render(scene, m, 64)) for m in ("LAYERED", "REFERENCE"))
    assert layered.keys() == reference.keys()
    for name in ("Depth", "CoC"):
        assert layered[name].tobytes() == reference[name].tobytes()
    matte = [found["Focus Matte"][..., 0] for found in (layered, reference)]
    assert np.abs(matte[0] - matte[1]).mean() < 0.02
    # The share of the first id of each pixel, where the same object has it.
    ranks = [found["CryptoObject00"] for found in (layered, reference)]
    same = ranks[0][..., 0] == ranks[1][..., 0]
    assert same.mean() > 0.9
    assert np.abs(ranks[0][..., 1] - ranks[1][..., 1])[same].mean() < 0.03


def test_a_view_of_nothing(scene):
    scene.camera.rotation_euler = (0.0, 0.0, 0.0)
    scene.camera.location = (0.0, 0.0, -50.0)
    picture = combined(render(scene, "LAYERED", 4))
    reference = combined(render(scene, "REFERENCE", 4))
    assert np.allclose(picture, reference, atol=1e-6)


def test_highlights_are_splatted_over_it(scene):
    # A lamp far out of focus: its disc is the same over either method.
    tree = surface_of(scene.objects["Far"])
    tree.emission((30.0, 24.0, 18.0))
    pictures = [combined(render(scene, method, 64)) for method in ("LAYERED", "ADAPTIVE")]
    assert energy_ratio(*pictures) == pytest.approx(1.0, abs=0.01)
    assert ssim(*pictures) > 0.98


def test_a_floor_under_the_camera_takes_no_layers_from_what_is_in_view(scene, aplanat_bpy):
    # Of its depths from the near plane on, those that are seen count.
    add_plane(aplanat_bpy, "Floor", (0.0, 10.0, -1.2), 40.0, color=(0.3, 0.2, 0.1))
    scene.render.resolution_x, scene.render.resolution_y = 96, 54
    pictures = []
    for clip_start in (0.001, 1.0):
        scene.camera.data.clip_start = clip_start
        pictures.append(combined(render(scene, "LAYERED", 16)))
    # The same cuts but for rounding; 0.98 when they began at the near plane.
    assert ssim(*pictures) > 0.999


def test_a_border_is_blurred_over_by_what_lies_beyond_it(scene):
    whole = combined(render(scene, "LAYERED", 64))[62:72, 58:66, :3]
    border = scene.render
    border.use_border = border.use_crop_to_border = True
    border.border_min_x, border.border_max_x = 58 / WIDTH, 66 / WIDTH
    border.border_min_y, border.border_max_y = 18 / HEIGHT, 28 / HEIGHT
    part = combined(render(scene, "LAYERED", 64))[..., :3]
    # Noise of other places on the lens is 0.15 %; with a quarter of the part's own 10 px as
    # overscan, of a blur of 15, red missed 12 %.
    np.testing.assert_allclose(part.mean((0, 1)), whole.mean((0, 1)), rtol=0.01)


def test_peeled_layers_are_the_reference(scene, tmp_path):
    scene.aplanat.layer_source = "PEELING"
    scene.aplanat.layers = 4
    check(scene, tmp_path, 0.97)


def test_peeling_keeps_what_one_slice_holds_twice(scene, aplanat_bpy, monkeypatch):
    # The far ball, seen by parts of the lens past a wall that is in the same slice.
    blob(aplanat_bpy, "Wall", (0.4, FOCUS + 1.2, 0.0), 1.0, ((0.9, 0.1, 0.6), (0.1, 0.0, 0.2)))
    # Front and back of two balls.
    scene.aplanat.layers = 4
    reference = combined(render(scene, "REFERENCE", TRUTH))
    slices = combined(render(scene, "LAYERED", 32))
    scene.aplanat.layer_source = "PEELING"
    culled = combined(render(scene, "LAYERED", 32))
    rim = np.s_[8:50, 108:124]
    lost = [np.abs((seen - reference)[rim].mean(axis=(0, 1))) for seen in (culled, slices)]
    assert lost[0].max() < 0.5 * lost[1].max()
    changed_plan(monkeypatch, culls=False)
    assert combined(render(scene, "LAYERED", 32)).tobytes() == culled.tobytes()


def test_reflections_depend_on_the_place_on_the_lens(scene, aplanat_bpy, tmp_path):
    # Lamps mirrored in polished balls: each place on the lens sees their reflections elsewhere.
    bpy = aplanat_bpy
    for thing in scene.objects:
        if thing.type == "MESH":
            thing.data.shade_smooth()
            tree = surface_of(thing)
            polished = tree.node("BsdfPrincipled", {"Roughness": 0.3, "Metallic": 1.0})
            tree.tree.links.new(polished.outputs[0], tree.output.inputs[0])
    for place in ((-2.0, 0.0, 1.0), (3.0, 2.0, -1.0)):
        lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        lamp.data.energy = 200.0
        lamp.location = place
        scene.collection.objects.link(lamp)
    scene.camera.data.aplanat.bokeh.use = False
    reference = combined(render(scene, "REFERENCE", TRUTH))
    # Rays that are as thick as their part of the lens blur small reflections, the less the more.
    fixed = combined(render(scene, "LAYERED", 192))
    scene.aplanat.use_view_dependence = True
    moving = combined(render(scene, "LAYERED", 192))
    save_side_by_side(tmp_path / "layered_reference_difference.png", moving, reference)
    # The near ball is left out: there noise is more than the difference.
    right = np.s_[:, 50:]
    fixed, moving = (np.abs(found - reference)[right].mean() for found in (fixed, moving))
    assert moving < 0.5 * fixed, tmp_path
