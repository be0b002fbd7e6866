"""What is a highlight where nobody says so: what is far brighter than its surroundings, blurred."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.sampling.highlights import contrast

from ...conftest import make_renderer, render_snapshot, triangles_snapshot
from ..bokeh_scenes import HEIGHT, LENS, WIDTH, energy, lamp, with_bokeh
from .test_lens_views import glossy_ball

pytestmark = pytest.mark.usefixtures("gpu_context")


def scene(corners, lights, samples=64):
    return triangles_snapshot(corners, lights, WIDTH, HEIGHT, LENS, samples)


def test_a_wide_bright_surface_keeps_its_bits():
    """It fills half of the circles around its edges, and a quarter of those around its corners."""
    square = np.array([(-1.5, -1.0), (1.6, -0.9), (1.4, 1.1), (-1.4, 1.0)])
    square = np.column_stack([square, np.full(4, -8.0)])
    wide = scene([square[[0, 1, 2]], square[[0, 2, 3]]], [(6.0, 5.0, 4.0)] * 2)
    pictures = render_snapshot(with_bokeh(wide, highlights="AUTO"))
    assert (pictures["Bokeh"] == 0.0).all()
    assert pictures["Combined"].tobytes() == render_snapshot(wide)["Combined"].tobytes()
    # Above the same threshold everywhere, nearly all of it is a highlight.
    fixed = render_snapshot(with_bokeh(wide))
    assert energy(fixed["Bokeh"])[0] > 0.5 * energy(fixed["Combined"])[0]


def test_a_lamp_is_the_disc_that_it_is_above_a_threshold():
    small = scene([lamp(0.3, -0.2, 8.0, 0.08)], [(40.0, 30.0, 20.0)])
    renderer = make_renderer(with_bokeh(small, highlights="AUTO"))
    renderer.advance(1)
    least, largest = renderer.thresholds
    assert 1.0 <= least <= largest < 0.25 * 40.0
    renderer.release()
    found, fixed = (
        render_snapshot(with_bokeh(small, highlights=choice))["Bokeh"]
        for choice in ("AUTO", "THRESHOLD")
    )
    # Both thresholds are far below its light.
    assert found == pytest.approx(fixed, abs=1e-4 * float(fixed.max()))


@pytest.mark.parametrize("size", [0.12, 0.4, 1.2])
def test_light_is_shared_between_samples_and_discs_without_loss(size):
    """Whatever share of its circle a lamp fills, and beside a wide surface brighter than white."""
    wall = np.array([(-9.0, -6.0, -8.3), (9.0, -6.0, -8.3), (0.0, 15.0, -8.3)])
    lit = scene([lamp(0.2, -0.1, 8.0, size), wall], [(60.0, 40.0, 20.0), (1.5, 1.4, 1.3)], 256)
    whole = energy(render_snapshot(lit)["Combined"])
    split = render_snapshot(with_bokeh(lit, highlights="AUTO"))
    assert energy(split["Combined"]) == pytest.approx(whole, rel=0.003)
    # Of the largest only the tips, acute as they are, are little of the circles around them.
    share = energy(split["Bokeh"])[0] / whole[0]
    assert share > 0.005 if size < 1.0 else share < 0.001


def test_glints_are_found_and_nothing_else_is_searched():
    """A ball that mirrors two lamps: its light is that of the reference method."""
    reference = energy(render_snapshot(glossy_ball(1, 2048, bokeh=False))["Combined"])
    snapshot = glossy_ball(4, 256)
    bokeh = replace(snapshot.camera.bokeh, highlights="AUTO")
    snapshot = replace(snapshot, camera=replace(snapshot.camera, bokeh=bokeh))
    pictures = render_snapshot(snapshot)
    assert energy(pictures["Bokeh"]).min() > 0.02 * reference.min()
    # As with a threshold: glints differ over the lens.
    assert energy(pictures["Combined"]) == pytest.approx(reference, rel=0.025)


def test_more_samples_leave_more_to_them():
    assert [contrast(samples) for samples in (16, 768, 4096)] == [5.0, 5.0, 17.0]
    small = scene([lamp(0.0, 0.0, 8.0, 0.2)], [(9.0,) * 3])
    assert plan_frame(with_bokeh(small, highlights="AUTO")).bokeh.contrast == 5.0
    assert plan_frame(with_bokeh(small)).bokeh.contrast == 0.0
