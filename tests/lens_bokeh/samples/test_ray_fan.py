"""Sums of terms over the iris, and the tables that are made of them."""

import numpy as np
import pytest

from addon.lens_bokeh.samples import landing, stop_rays
from addon.lens_bokeh.samples.disc_terms import disc_terms
from addon.lens_bokeh.samples.field_grid import field_grid
from addon.lens_bokeh.samples.landing import spread_places
from addon.lens_bokeh.samples.lens_rays import lens_rays
from addon.lens_io.lens_shelf import LensShelf
from addon.optics.focus import focused
from addon.optics.paraxial import first_order
from addon.optics.rays.trace import Rays, trace

FOCUS = 2.0
LINE = 587.5618


def prescription(name):
    return LensShelf([]).find(name).lens.prescription


def test_sums_follow_the_rays_of_a_lens_whose_rim_sends_them_far_astray():
    lens = prescription("sonnar-50mm-f1.5")
    rays = lens_rays(lens, None, FOCUS, 1.5, 0.4)
    # An axial point in focus, by rays through places of the entrance pupil.
    distance = FOCUS * 1000.0
    configuration = lens.configuration(None)
    for _ in range(4):
        pupil = first_order(configuration).enp_z
        configuration = focused(lens.configuration(None), distance - pupil, lens.focus)
    heights = np.linspace(0.5, 15.0, 40)
    origins = np.column_stack([np.zeros(40), heights, np.full(40, pupil)])
    directions = np.column_stack([np.zeros(40), heights / distance, np.ones(40)])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    traced = trace(configuration, Rays(origins, directions), LINE, clip=False)
    wanted = traced.at_plane(configuration.sensor)[:, 1]
    # Blur is no narrower than the sums have it, on most of the iris.
    places = spread_places(400)
    moves, _ = rays.moves(np.zeros((1, 2)))
    powers = (rays.focus_vergence / rays.largest_vergence) ** np.arange(4)
    found = disc_terms(rays.orders, places).reshape(400, -1) @ (moves[:, 0] * powers[:, None]).sum(
        1
    )
    # In mm on the sensor: of 36 mm, a pixel of a picture 1440 px wide is 0.025.
    found = 17.0 * np.linalg.norm(found - found[0], axis=-1) / 1000.0 * 50.0
    inner = np.hypot(*places.T) < 0.6
    assert np.abs(wanted[heights < 0.6 * 17.0]).max() < 0.05
    assert found[inner].max() < 0.06


@pytest.mark.parametrize("name", ["double-gauss-50mm-f2", "petzval-51mm-f1.4"])
def test_what_lands_beside_the_axis_lands_all_round_it(name):
    rays = lens_rays(prescription(name), None, FOCUS, 2.0, 0.14)
    half = np.array([0.09, 0.06])
    grid = field_grid(-half, half)
    rng = np.random.default_rng(5)
    wanted = rng.uniform(-half, half, (30, 2))
    found = landing.landed(rays, 0.012, grid, wanted)
    around = grid.padded(4)
    whole = landing._on_grid(rays, 0.012, around, wanted)
    places = disc_terms(rays.orders, spread_places(100)).reshape(100, -1)
    light, same = places @ found[0], places @ whole[0]
    # Straight lines between nodes on both ways.
    assert np.abs(light - same).max() < 2e-3


def test_light_of_rays_is_found_in_one_trace(monkeypatch):
    # A trace of few rays takes as long as one of many: calls of numpy, hundreds of them.
    numbers = []
    aim = stop_rays.StopAim(
        prescription("double-gauss-50mm-f2").configuration(None), 30.0, 12, LINE
    )
    traced = aim._traced
    monkeypatch.setattr(
        aim, "_traced", lambda *given, **options: numbers.append(1) or traced(*given, **options)
    )
    places = np.random.default_rng(2).uniform(-5.0, 5.0, (7, 2))
    light = aim.throughput(0.1, np.full(7, 1e-3), places)
    assert len(numbers) == 1
    alone = [aim.throughput(0.1, np.array([1e-3]), place[None])[0] for place in places]
    assert light == pytest.approx(alone, rel=1e-9)
