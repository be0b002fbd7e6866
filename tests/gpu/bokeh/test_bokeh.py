"""Highlights, from the split to the splat, against numpy and against the reference method."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.bokeh import listing, search_tiles
from addon.engine.planning.plan import plan_frame
from addon.sampling.highlights import highlight_light
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens

from ..conftest import (
    WORLD_COLOR,
    make_renderer,
    render_snapshot,
    some_triangles,
    triangles_snapshot,
)
from .bokeh_scenes import HEIGHT, LENS, PASSES, WIDTH, energy, lamp, lamps, with_bokeh

pytestmark = pytest.mark.usefixtures("gpu_context")


def test_combined_is_the_sum_of_defocus_and_bokeh_to_the_last_bit():
    pictures = render_snapshot(with_bokeh(lamps()))
    assert energy(pictures["Bokeh"]).min() > 0.0
    total = pictures["Defocus"] + pictures["Bokeh"]
    assert pictures["Combined"].tobytes() == total.tobytes()
    # Light alone: what covers the film is all in the samples.
    assert (pictures["Bokeh"][..., 3] == 0.0).all()


def test_without_bokeh_the_passes_are_the_picture_and_black():
    pictures = render_snapshot(replace(lamps(), passes=PASSES))
    assert pictures["Defocus"].tobytes() == pictures["Combined"].tobytes()
    assert (pictures["Bokeh"] == 0.0).all()
    assert pictures["Combined"].tobytes() == render_snapshot(lamps())["Combined"].tobytes()


def test_dark_scenes_keep_their_bits():
    corners, colors = some_triangles()
    plain = triangles_snapshot(corners, colors, WIDTH, HEIGHT, LENS)
    split = render_snapshot(with_bokeh(plain))
    assert split["Combined"].tobytes() == render_snapshot(plain)["Combined"].tobytes()


@pytest.mark.parametrize("iris", [Iris(), Iris(3, 0.4), Iris(5, 0.1, 1.8)])
@pytest.mark.parametrize("parallel", [False, True])
def test_splats_are_what_the_reference_method_converges_to(iris, parallel):
    lens = ThinLens(0.25, 3.0, iris)
    few = with_bokeh(lamps(lens, samples=64, parallel=parallel))
    picture = render_snapshot(few)["Combined"].astype(np.float64)
    many = render_snapshot(lamps(lens, samples=4096, parallel=parallel))["Combined"]
    # Lamps of 3 pixels, met by sub-pixels of a half to a quarter: a few per cent.
    black = np.array(WORLD_COLOR) * WIDTH * HEIGHT
    assert energy(picture) - black == pytest.approx(energy(many) - black, rel=0.03)
    peak = many[..., :3].max()
    error = np.abs(picture - many)[..., :3]
    # Noise of 4096 samples; a disc of another size, place or orientation would differ by its
    # whole brightness along its edges.
    assert np.sqrt((error**2).mean()) < 0.02 * peak
    assert error.max() < 0.25 * peak


@pytest.mark.parametrize("diameter_px", [3.0, 1.2, 0.5])
def test_a_lone_lamp_keeps_its_energy_in_a_slow_pan(diameter_px):
    depth = 8.0
    pixel = 2.0 * 0.5 * depth / WIDTH
    light, found = (20.0, 10.0, 5.0), []
    for step in range(8):
        place = (0.3 + 0.17 * step * pixel, -0.2 + 0.07 * step * pixel)
        corners = lamp(*place, depth, 0.5 * diameter_px * pixel)
        a, b = (corners[i, :2] - corners[0, :2] for i in (1, 2))
        area = 0.5 * abs(a[0] * b[1] - a[1] * b[0]) / pixel**2
        snapshot = triangles_snapshot([corners], [light], WIDTH, HEIGHT, LENS, 4)
        picture = render_snapshot(with_bokeh(snapshot, passes=("Bokeh",)))["Bokeh"]
        found.append(energy(picture)[0] / (area * light[0]))
    assert found == pytest.approx([1.0] * len(found), abs=0.01)


def test_discs_do_not_depend_on_how_finely_the_samples_are_drawn(monkeypatch):
    coarse = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    monkeypatch.setattr("addon.engine.planning.plan.subpixels", lambda *_: 2)
    plan = plan_frame(with_bokeh(lamps()))
    assert plan.subpixels == 2
    assert render_snapshot(with_bokeh(lamps()), plan)["Bokeh"].tobytes() == coarse.tobytes()


def test_light_from_outside_the_frame_reaches_in():
    corners = [lamp(4.25, 0.0, 8.0, 0.1)]
    lights = [(300.0, 300.0, 300.0)]
    plain = triangles_snapshot(corners, lights, WIDTH, HEIGHT, LENS, 16)
    picture = render_snapshot(with_bokeh(plain, overscan=1.0))["Bokeh"]
    assert energy(picture)[0] > 1.0
    assert (picture[:, : WIDTH // 2] == 0.0).all()


def test_tiles_find_what_the_whole_raster_does(monkeypatch):
    whole = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    monkeypatch.setattr(search_tiles, "_LARGEST_TILE", 1 << 14)
    plan = plan_frame(with_bokeh(lamps())).bokeh
    assert len(search_tiles.tiles_of(plan.part, plan.subpixels)) > 3
    tiles = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    # The same highlights in another order.
    assert tiles == pytest.approx(whole, abs=1e-5 * float(whole.max()))


def test_surfaces_are_searched_once_however_many_layers_there_are():
    drawn = []
    for layers in (1, 32):
        renderer = make_renderer(with_bokeh(lamps(), layers=layers))
        renderer.advance(1)
        drawn.append(renderer.counts.draw_calls)
        renderer.release()
    assert drawn[0] == drawn[1]


def test_more_fragments_than_there_is_room_for_are_all_found(monkeypatch):
    whole = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    monkeypatch.setattr(listing, "_LEAST_ROOM", 1 << 10)
    monkeypatch.setattr(listing, "_ROOM", 0.0)
    again = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    assert again.tobytes() == whole.tobytes()
    # Now the tile is divided.
    monkeypatch.setattr(listing, "_MOST_ROOM", 1 << 10)
    divided = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    # The same highlights in another order.
    assert divided == pytest.approx(whole, abs=1e-5 * float(whole.max()))


def test_gain_multiplies_what_lies_above_the_threshold():
    gains = (0.0, 1.0, 2.0)
    none, once, twice = (render_snapshot(with_bokeh(lamps(), gain=gain)) for gain in gains)
    above = energy(once["Bokeh"]) - energy(none["Bokeh"])
    assert energy(twice["Bokeh"]) - energy(once["Bokeh"]) == pytest.approx(above, rel=1e-5)
    assert twice["Defocus"].tobytes() == none["Defocus"].tobytes()


def test_the_split_on_the_device_is_that_of_the_twin():
    # A lamp that fills the frame, far out of focus: every sample keeps the same.
    corners = [lamp(0.0, 0.0, 1.0, 9.0)]
    light = (3.0, 0.3, 0.03)
    snapshot = triangles_snapshot(corners, [light], 16, 16, ThinLens(1.0, 3.0), 1)
    kept = render_snapshot(with_bokeh(snapshot, threshold=2.0))["Defocus"]
    expected = np.array(light) - highlight_light(np.array(light), 2.0)
    assert kept[..., :3].reshape(-1, 3) == pytest.approx(np.tile(expected, (256, 1)), rel=1e-6)


def test_highlights_are_counted():
    renderer = make_renderer(with_bokeh(lamps()))
    renderer.advance(1)
    counts = renderer.highlights
    assert counts.found == counts.clustered + counts.culled_size > 0
    assert counts.splatted <= counts.clustered
    renderer.release()


def test_samples_go_on_from_the_same_bokeh():
    renderer = make_renderer(with_bokeh(lamps()))
    renderer.advance(1)
    first = renderer.read_passes(("Bokeh",))["Bokeh"]
    renderer.advance(15)
    assert renderer.read_passes(("Bokeh",))["Bokeh"].tobytes() == first.tobytes()
    renderer.release()
