"""Bokeh of a captured picture's highlights: against very many lens samples, and its bookkeeping."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.layered.stack_highlights import find_highlights
from addon.engine.layered.stack_occluders import occluding_surfaces
from addon.engine.refocus.refocusing import Refocusing, refocus
from addon.engine.refocus.settings import RefocusSettings
from addon.layers.layer_stack import DepthLayer
from addon.passes.layered.layers import EMPTY
from addon.sampling.chromatic import ChromaticAberration, Dispersion
from addon.snapshot.camera import BokehSettings
from tests.engine.test_refocus import stack as cards
from tests.pictures import energy_ratio, ssim

__all__ = ["cards"]

SETTINGS = RefocusSettings(f_stop=0.08, samples=32, bokeh=BokehSettings())


@pytest.fixture
def stack(cards, aplanat_bpy):
    """Lamps of a pixel on the front card, behind its edge, half a pixel wide, and in the world."""
    from addon.device.context import ensure_context

    ensure_context()
    front, back, world = cards.layers
    front.color[24, 30, :3] = (30.0, 15.0, 8.0)
    for (row, column), color in (
        ((20, 38), (20.0, 40.0, 20.0, 1.0)),
        ((36, 22), (6.0, 6.0, 30.0, 0.5)),
    ):
        back.color[row, column], back.depth[row, column] = color, 8.0
    world.color[40, 44, :3] = 50.0
    return cards


@pytest.mark.parametrize("values", [{}, {"visibility": "SPLAT"}, {"distortion": (-0.2,)}])
def test_discs_are_what_many_samples_show(stack, values):
    values = dict(values)
    lens = replace(SETTINGS, distortion=values.pop("distortion", ()))
    bokeh = BokehSettings(**values)
    many = replace(lens, samples=1024, bokeh=replace(bokeh, threshold=1e6))
    picture, truth = refocus(stack, replace(lens, bokeh=bokeh)), refocus(stack, many)
    assert ssim(picture, truth) > 0.975
    assert energy_ratio(picture, truth) == pytest.approx(1.0, abs=0.02)
    few = refocus(stack, replace(many, samples=32))
    assert ssim(few, truth) < ssim(picture, truth)


def test_bokeh_of_a_parallel_camera_is_that_of_many_samples(stack):
    # Every pixel of it shows the same point at infinity: no highlight.
    stack.layers[2].color[..., :3] = 0.2
    camera = replace(stack.camera, orthographic=True, aperture_radius=0.5)
    rows = np.array(camera.projection)
    rows[0, 0], rows[1, 1] = 0.25, 0.375
    rows[3] = 0.0, 0.0, 0.0, 1.0
    parallel = replace(stack, camera=replace(camera, projection=tuple(map(tuple, rows.tolist()))))
    settings = replace(SETTINGS, f_stop=0.5, focus_distance=4.0)
    many = replace(settings, samples=1024, bokeh=None)
    picture, truth = refocus(parallel, settings), refocus(parallel, many)
    assert ssim(picture, truth) > 0.97
    assert energy_ratio(picture, truth) == pytest.approx(1.0, abs=0.02)


def test_no_setting_before_changes_a_bit(stack):
    dispersion = Dispersion((400.0, 700.0), (0.98, 1.0))
    chromatic = ChromaticAberration("RGB", 1.0, 0.05, dispersion, 0.05)
    chain = [
        SETTINGS,
        replace(SETTINGS, bokeh=None),
        replace(SETTINGS, bokeh=BokehSettings(threshold=10.0)),
        replace(SETTINGS, bokeh=BokehSettings(threshold=1e6)),
        replace(SETTINGS, chromatic=chromatic, focus_distance=6.0),
        replace(SETTINGS, distortion=(0.1,)),
        replace(SETTINGS, f_stop=1000.0),
        SETTINGS,
    ]
    refocusing = Refocusing(stack, chain[-2])
    try:
        for settings in chain:
            refocusing.change(settings)
            refocusing.advance(settings.samples)
            assert refocusing.read().tobytes() == refocus(stack, settings).tobytes()
    finally:
        refocusing.release()


def pixel(color, depth):
    return DepthLayer(
        np.array(color, np.float32).reshape(1, 1, 4), np.full((1, 1), depth, np.float32)
    )


def test_a_lamp_in_two_layers_is_one_and_what_is_right_behind_it_hidden(stack):
    # Through the cut: the nearer layer fades, and measured its depth a little farther.
    lamp = (4.0, 4.0, 4.0, 0.4), (10.0, 10.0, 10.0, 1.0)
    layers = (pixel(lamp[0], 5.00001), pixel(lamp[1], 5.0), pixel((8.0, 8.0, 8.0, 1.0), 6.0))
    both = replace(stack, layers=layers, width=1, height=1, overscan=(0, 0))
    values = np.array([[[0.8000001]], [[0.8]], [[0.85]]], np.float32)
    found = find_highlights(both, values, 1.0)
    place, light = found.surfaces.place, found.surfaces.light
    assert place[:, 2].tolist() == [0, 1, 2] and (np.diff(place[:, 3]) > 2e-7).all()
    assert np.allclose(light, [(10, 10, 10, 0.4), (10, 10, 10, 1), (8, 8, 8, 1)])
    assert found.surfaces.front.tolist() == [[0.0, 0.0], [0.0, 0.0], [place[1, 3], 0.0]]
    surfaces, opacity = occluding_surfaces(both, values)
    assert surfaces[0, 0].tolist() == [values[0, 0, 0], values[2, 0, 0], EMPTY, EMPTY]
    assert opacity[0, 0, :2].tolist() == [1.0, 1.0]


def test_the_world_hidden_by_what_is_as_good_as_infinitely_far_is_no_highlight(stack):
    # The whole world shines; the wall before it moves against it by less than visibility tells.
    front, wall, world = stack.layers
    wall.color[..., :3], wall.color[..., 3] = 0.3, 1.0
    wall.depth[...] = 1e4
    world.color[..., :3] = 20.0
    picture, plain = (
        refocus(stack, replace(SETTINGS, samples=8, bokeh=bokeh))
        for bokeh in (BokehSettings(threshold=10.0), BokehSettings(threshold=1e6))
    )
    assert picture.max() < 20.0 and np.abs(picture - plain)[:, :8].max() < 1e-3
    wall.color[..., :3], wall.color[..., 3] = 0.15, 0.5
    picture, plain = (
        refocus(stack, replace(SETTINGS, samples=8, bokeh=bokeh))
        for bokeh in (BokehSettings(threshold=10.0), BokehSettings(threshold=1e6))
    )
    middle = np.s_[12:20, 2:8]
    assert np.allclose(picture[middle], plain[middle], rtol=0.02)
