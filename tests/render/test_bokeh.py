"""Final renders with highlights splatted against the reference method's: the same picture."""

import numpy as np
import pytest

from addon.engine.shared_resources import listen, resources
from benchmarks.bokeh.charts import LAMP_DEPTH, half_hidden, many_highlights
from benchmarks.bokeh.frames import PASSES
from tests.pictures import energy_ratio, save_side_by_side, ssim

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

SIZE = (120, 68)
TRUTH = 2048


@pytest.fixture
def bpy_of(aplanat_bpy):
    return aplanat_bpy


def render(bpy, method, samples, subsamples=0):
    """Render the open scene and return its passes, top row first."""
    scene = bpy.context.scene
    own, layer = scene.aplanat, scene.view_layers[0].aplanat
    own.method, own.use_target_error = method, False
    own.render_samples, own.subsamples = samples, subsamples
    layer.use_pass_defocus = layer.use_pass_bokeh = True
    with listen(keep_pictures=True) as heard:
        bpy.ops.render.render()
    assert heard.error is None
    found = heard.layers[0].passes
    return {name: found[name].pixels[::-1] for name in PASSES}, heard.statistics


@pytest.mark.parametrize("focus", [2.6, 6.0, 12.5])
def test_a_half_hidden_lamp_is_that_of_the_reference(bpy_of, tmp_path, focus):
    # Before both, between them and behind both: the disc is mirrored between the last two.
    scene = half_hidden(SIZE)
    scene.camera.data.dof.focus_distance = focus
    found, work = render(bpy_of, "ADAPTIVE", 32, 4)
    truth, _ = render(bpy_of, "REFERENCE", TRUTH)
    picture, expected = found["Combined"], truth["Combined"]
    save_side_by_side(tmp_path / "bokeh_reference_difference.png", picture, expected)
    # The bar for a focus pull.
    assert ssim(picture, expected) > 0.98, tmp_path
    assert ssim(picture, expected[::-1, ::-1]) < ssim(picture, expected) - 0.02
    assert energy_ratio(picture, expected) == pytest.approx(1.0, abs=0.01)
    assert work.highlights["found"] > 0 and work.highlights["masked"] > 0


def test_lamps_behind_bars_are_those_of_the_reference(bpy_of, tmp_path):
    many_highlights(SIZE, 60)
    found, _ = render(bpy_of, "ADAPTIVE", 64, 4)
    truth, _ = render(bpy_of, "REFERENCE", TRUTH)
    picture, expected = found["Combined"], truth["Combined"]
    save_side_by_side(tmp_path / "bokeh_reference_difference.png", picture, expected)
    assert ssim(picture, expected) > 0.97, tmp_path
    assert energy_ratio(picture, expected) == pytest.approx(1.0, abs=0.01)


def test_defocus_and_bokeh_add_up_to_combined_to_the_last_bit(bpy_of):
    many_highlights(SIZE, 50)
    found, _ = render(bpy_of, "ADAPTIVE", 8)
    assert found["Bokeh"][..., :3].max() > 0.1
    total = found["Defocus"] + found["Bokeh"]
    assert total.tobytes() == found["Combined"].tobytes()


def test_without_bokeh_the_defocus_is_the_whole_picture(bpy_of):
    scene = half_hidden(SIZE)
    scene.camera.data.aplanat.bokeh.use = False
    found, work = render(bpy_of, "ADAPTIVE", 8)
    assert not found["Bokeh"].any()
    assert np.array_equal(found["Defocus"], found["Combined"])
    assert work.highlights["found"] == 0


def test_the_same_frame_twice_has_the_same_highlights(bpy_of):
    scene = half_hidden(SIZE)
    scene.camera.data.dof.focus_distance = 0.5 * LAMP_DEPTH
    first, second = (render(bpy_of, "ADAPTIVE", 4)[0] for _ in range(2))
    assert first["Bokeh"].tobytes() == second["Bokeh"].tobytes()


def test_a_lens_that_cannot_focus_so_near_leaves_the_discs_to_a_thin_lens(bpy_of):
    scene = half_hidden(SIZE)
    camera = scene.camera.data
    # Nearer than the focal length of the lens.
    camera.dof.focus_distance, camera.dof.aperture_fstop = 0.03, 16.0
    thin, work = render(bpy_of, "ADAPTIVE", 4)
    assert work.highlights["splatted"] > 0
    camera.aplanat.lens = "double-gauss-50mm-f2"
    drawn, _ = render(bpy_of, "ADAPTIVE", 4)
    assert np.array_equal(drawn["Combined"], thin["Combined"])
    (problem,) = resources().notes.of(scene).problems
    assert "double" in problem.lower() and "focus farther away" in problem
    camera.dof.focus_distance = 6.0
    render(bpy_of, "ADAPTIVE", 4)
    assert resources().notes.of(scene).problems == ()
