"""Lights whose reflections never shine as bokeh: what surfaces reflect of them is sampled whole."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame

from ..conftest import render_snapshot
from .bokeh_scenes import energy
from .search.test_lens_views import glossy_ball

pytestmark = pytest.mark.usefixtures("gpu_context")


def ball_under(may_shine, **options):
    """Return a glossy ball under two lamps, and whether each may shine as bokeh."""
    snapshot = glossy_ball(4, 16, **options)
    lights = [
        replace(light, highlights=may)
        for light, may in zip(snapshot.content.lights, may_shine, strict=True)
    ]
    return replace(snapshot, content=replace(snapshot.content, lights=tuple(lights)))


def test_what_a_lamp_may_not_give_to_the_bokeh_stays_in_the_samples():
    plain = render_snapshot(ball_under((True, True), bokeh=False))
    both = render_snapshot(ball_under((True, True)))
    left, right = (render_snapshot(ball_under(may)) for may in ((True, False), (False, True)))
    assert energy(both["Bokeh"]).min() > 0.0
    for found in (left, right):
        assert energy(found["Bokeh"]).min() > 0.0
        assert (energy(found["Bokeh"]) < 0.8 * energy(both["Bokeh"])).all()
        # Where in the picture a disc's light lands in whole pixels.
        assert energy(found["Combined"]) == pytest.approx(energy(plain["Combined"]), rel=0.01)
    # The two reflections lie apart, and the threshold takes the same of each as of the sum.
    parts = left["Bokeh"] + right["Bokeh"]
    assert energy(parts) == pytest.approx(energy(both["Bokeh"]), rel=0.01)


def test_where_no_lamp_may_shine_nothing_is_searched_and_the_picture_is_as_without_bokeh():
    snapshot = ball_under((False, False))
    assert plan_frame(snapshot).bokeh is None
    found = render_snapshot(snapshot)
    plain = render_snapshot(ball_under((True, True), bokeh=False))
    assert not found["Bokeh"].any()
    assert np.array_equal(found["Combined"], plain["Combined"])
