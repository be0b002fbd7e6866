"""A captured picture seen through the lens: against rays through flat cards, and the refusals."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from addon.engine.layered import layered_drawing
from addon.engine.refocus import live_picture
from addon.engine.refocus.refocusing import Refocusing, planned_frame, refocus
from addon.engine.refocus.settings import RefocusSettings, bokeh_of, lens_of
from addon.errors import FocusError
from addon.layers.layer_stack import DepthLayer, LayerCamera, LayerStack
from addon.lens_bokeh.look.appearance import Appearance
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.pictures import PictureIris
from addon.lens_bokeh.openings.shapes import iris_of
from addon.snapshot.camera import BokehSettings
from tests.lens_bokeh.openings.shapes import heart
from tests.splat_pictures import library_lens

WIDTH, HEIGHT, OVERSCAN = 48, 32, 8
FOCUS = 4.0


def camera(**settings):
    # 36 mm across at 50 mm.
    across = 2.0 * 50.0 / 36.0
    rows = (
        (across, 0.0, 0.0, 0.0),
        (0.0, across * WIDTH / HEIGHT, 0.0, 0.0),
        (0.0, 0.0, -1.002, -0.2002),
        (0.0, 0.0, -1.0, 0.0),
    )
    return LayerCamera(rows, f_stop=0.5, focus_distance=FOCUS, focal_length_mm=50.0, **settings)


def card(depth, color, cover):
    pixels = np.zeros((HEIGHT + 2 * OVERSCAN, WIDTH + 2 * OVERSCAN, 4), np.float32)
    pixels[cover] = (*color, 1.0)
    covered = pixels[..., 3] > 0.0
    return DepthLayer(pixels, np.where(covered, depth, np.inf).astype(np.float32))


@pytest.fixture
def stack():
    """A small card in front of a striped one, before a grey world."""
    rows, columns = np.mgrid[0 : HEIGHT + 2 * OVERSCAN, 0 : WIDTH + 2 * OVERSCAN]
    front = card(2.0, (1.0, 0.3, 0.1), (abs(rows - 24) < 5) & (abs(columns - 30) < 6))
    back = card(8.0, (0.1, 0.4, 0.9), columns % 12 < 6)
    world = card(np.inf, (0.2, 0.2, 0.2), np.full(rows.shape, True))
    return LayerStack((front, back, world), camera(), WIDTH, HEIGHT, (OVERSCAN, OVERSCAN))


def traced(stack, lens, places):
    """The picture by rays through flat cards: each is looked up where the ray crosses it."""
    total = np.zeros((HEIGHT, WIDTH, 4))
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    scale = np.array([50.0 / 36.0 * WIDTH, 50.0 / 36.0 * WIDTH])
    for place in places:
        through = np.ones((HEIGHT, WIDTH, 1))
        for layer in stack.layers:
            depth = layer.depth[np.isfinite(layer.depth)]
            away = 1.0 / depth[0] if depth.size else 0.0
            moved = scale * place * (1.0 / lens.focus_distance - away)
            x = np.floor(columns + 0.5 - moved[0] + OVERSCAN).astype(int)
            y = np.floor(rows + 0.5 - moved[1] + OVERSCAN).astype(int)
            x, y = x.clip(0, layer.depth.shape[1] - 1), y.clip(0, layer.depth.shape[0] - 1)
            color = layer.color[y, x]
            total += through * color
            through = through * (1.0 - color[..., 3:])
    return total / len(places)


@pytest.mark.parametrize("focus", [2.0, 4.0, 8.0, 100.0])
def test_the_picture_is_that_of_rays_through_the_layers(aplanat_bpy, stack, focus):
    from addon.device.context import ensure_context
    from addon.sampling.sequence import lens_samples

    ensure_context()
    settings = RefocusSettings(focus_distance=focus, samples=64)
    lens = lens_of(stack, settings)
    picture = refocus(stack, settings)
    places = lens_samples(0, 1024, lens.iris, 5) * lens.aperture_radius
    expected = traced(stack, lens, places)
    # Noise of 64 places on the lens, in pictures that go from 0 to 1; colours are mixed between
    # texels here and not there, which edges in focus show most.
    assert np.abs(picture - expected).mean() < 0.02
    assert picture.sum() == pytest.approx(expected.sum(), rel=0.01)
    assert np.allclose(picture[..., 3], 1.0, atol=0.01)


def test_a_small_aperture_gives_the_layers_laid_over_each_other(aplanat_bpy, stack):
    from addon.device.context import ensure_context

    ensure_context()
    picture = refocus(stack, RefocusSettings(f_stop=1000.0, samples=4))
    expected = traced(stack, lens_of(stack, RefocusSettings()), np.zeros((1, 2)))
    assert np.allclose(picture, expected, atol=2e-3)


def test_what_was_seen_before_changes_no_bit(aplanat_bpy, stack):
    from addon.device.context import ensure_context

    ensure_context()
    wanted = RefocusSettings(focus_distance=3.0, samples=8)
    refocusing = Refocusing(stack, RefocusSettings(focus_distance=8.0, f_stop=1.0, samples=4))
    try:
        refocusing.advance(4)
        refocusing.change(wanted)
        assert refocusing.advance(3)
        with pytest.raises(FocusError):
            refocusing.change(RefocusSettings(focus_distance=0.0))
        refocusing.change(RefocusSettings(focus_distance=3.0, samples=8))
        assert refocusing.samples_done == 3
        assert not refocusing.advance(100)
        picture = refocusing.read()
    finally:
        refocusing.release()
    assert picture.tobytes() == refocus(stack, wanted).tobytes()


def test_it_can_be_ended(aplanat_bpy, stack):
    from addon.device.context import ensure_context

    ensure_context()
    assert refocus(stack, RefocusSettings(samples=64), go_on=lambda share: share < 0.3) is None


def test_what_forms_no_picture_is_refused(stack):
    for settings in (RefocusSettings(focus_distance=0.0), RefocusSettings(focus_distance=-1.0)):
        with pytest.raises(FocusError, match="focus distance"):
            lens_of(stack, settings)


def test_more_samples_than_a_texture_is_wide_follow_in_further_rows(stack, monkeypatch):
    settings = RefocusSettings(2.0, samples=10)
    expected = refocus(stack, settings)
    # Devices have 8192 columns and more: a table of so many samples takes too long here.
    monkeypatch.setattr(layered_drawing._folded, "__defaults__", (4,))
    assert refocus(stack, settings).tobytes() == expected.tobytes()


def test_blades_follow_the_f_number_that_is_asked_for(stack):
    wide = library_lens("double-gauss-50mm-f2")
    opening = BladedIris(5, 0.2, 0.3, wide.closing)
    bokeh = BokehSettings(appearance=Appearance(iris=opening))
    settings = RefocusSettings(iris=iris_of(opening), real_lens=wide, bokeh=bokeh)
    for f_stop, is_round in ((1.0, True), (4.0, False)):
        asked = replace(settings, f_stop=f_stop)
        lens, look = lens_of(stack, asked), bokeh_of(stack, asked).appearance
        assert lens.iris.opening.is_round is is_round
        assert look.iris == lens.iris.opening
    # A thin lens has no widest f-number.
    thin = lens_of(stack, replace(settings, real_lens=None))
    assert thin.iris.opening == BladedIris(5, 0.2, 0.3)


def test_the_picture_is_blurred_by_the_iris_image(aplanat_bpy, stack):
    from addon.device.context import ensure_context
    from addon.sampling.sequence import lens_samples

    ensure_context()
    iris = iris_of(PictureIris(heart()))
    settings = RefocusSettings(iris=iris, samples=64)
    lens = lens_of(stack, settings)
    picture = refocus(stack, settings)
    expected = traced(stack, lens, lens_samples(0, 1024, iris, 5) * lens.aperture_radius)
    assert np.abs(picture - expected).mean() < 0.02


def test_rays_of_a_real_lens_are_traced_beside_the_live_picture(aplanat_bpy, stack, monkeypatch):
    made, may_trace = [], threading.Event()

    def planned(stack, settings, content):
        assert threading.current_thread() is not threading.main_thread()
        assert may_trace.wait(60)
        made.append(settings.focus_distance)
        return planned_frame(stack, settings, content)

    monkeypatch.setattr(live_picture, "planned_frame", planned)
    lens = library_lens("singlet-planoconvex-100mm")
    picture = live_picture.LivePicture(stack)
    try:
        wanted = [RefocusSettings(focus, real_lens=lens, samples=8) for focus in (3.0, 4.0, 5.0)]
        for settings in wanted:
            picture.change(settings)
            assert picture.refine() is None and not picture.is_planned
        may_trace.set()
        end = time.monotonic() + 60.0
        while not picture.finished and time.monotonic() < end:
            found = picture.refine()
        # What was asked for in between is left out, and nothing of it is in the picture.
        assert made == [3.0, 5.0]
        np.testing.assert_array_equal(found, refocus(stack, wanted[-1]))
    finally:
        may_trace.set()
        picture.release()
