"""An artist's lens: its formulas, the tables of its samples, the tiles of its discs."""

from functools import cache

import numpy as np
import pytest

from addon.lens_bokeh.look.artist_beams import ArtistBeams
from addon.lens_bokeh.look.splat_pupil import FIELDS
from addon.lens_bokeh.samples.artist_rays import ArtistRays
from addon.lens_bokeh.samples.field_grid import field_grid
from addon.lens_bokeh.samples.sample_tables import sample_tables
from addon.lens_bokeh.tables.artist_lens import UNIT, ArtistLens, opening_at

RADIUS, FOCUS, CORNER = 0.0125, 0.5, 0.43
HALF = CORNER * np.array([3.0, 2.0]) / np.sqrt(13.0)


@cache
def tables(lens, f_number=2.0):
    rays = ArtistRays(lens, opening_at(f_number), CORNER, RADIUS, FOCUS)
    grids = field_grid(-HALF, HALF), field_grid(-HALF, HALF, 0.1)
    return sample_tables(rays, *grids, RADIUS)


def moved(lens, seen, vergence, place, f_number=2.0):
    """Where a sample has a point beside a thin lens, over the distance to the corner."""
    made = tables(lens, f_number)
    position = np.array(place) * RADIUS
    point = np.array([[*(np.array(seen) / vergence), -1.0 / vergence]])
    found = made.displaced(point, made.moves(position[None])[0], position)[0, :2] * vergence
    return (found - seen - position * (FOCUS - vergence)) / CORNER


@pytest.mark.parametrize(("f_number", "share"), [(2.0, 1.0), (4.0, 0.125)])
def test_spherical_aberration_is_a_hundredth_at_the_rim_and_falls_with_its_cube(f_number, share):
    lens = ArtistLens(spherical=1.0)
    found = moved(lens, (0.1, -0.05), FOCUS, (0.0, 1.0), f_number)
    np.testing.assert_allclose(found, (0.0, UNIT * share), atol=1e-6)
    half = moved(lens, (0.1, -0.05), FOCUS, (0.5, 0.0), f_number)
    np.testing.assert_allclose(half, (UNIT * share / 8.0, 0.0), atol=1e-6)


def test_coma_points_outwards_and_vanishes_in_the_middle():
    lens = ArtistLens(coma=1.0)
    right = np.array([CORNER / 2.0, 0.0])
    for place in ((1.0, 0.0), (0.0, 1.0), (-0.6, 0.3)):
        found = moved(lens, right * 0.999, FOCUS, place)
        wanted = 0.5 * UNIT * np.array([3.0 * place[0] ** 2 + place[1] ** 2, 2.0 * np.prod(place)])
        np.testing.assert_allclose(found, wanted, atol=2e-4 * UNIT + 2e-5)
    assert np.abs(moved(lens, (0.0, 0.0), FOCUS, (1.0, 0.0))).max() < 1e-3 * UNIT


def test_astigmatism_and_curvature_move_the_focus_along_and_around():
    seen = np.array([0.0, 0.8 * HALF[1]])
    share = (seen[1] / CORNER) ** 2
    for lens, signs in (
        (ArtistLens(astigmatism=1.0), (-1, 1)),
        (ArtistLens(field_curvature=1.0), (1, 1)),
    ):
        for place in np.eye(2):
            found = moved(lens, seen, FOCUS, place)
            np.testing.assert_allclose(found, UNIT * share * place * signs, atol=2e-5)


def test_a_swirl_narrows_blur_away_from_the_middle_alone():
    lens = ArtistLens(swirl=0.5)
    seen = np.array([0.7 * HALF[0], 0.0])
    share = (seen[0] / CORNER) ** 2
    for vergence in (0.1, 0.3, 1.2):
        away = moved(lens, seen, vergence, (1.0, 0.0))
        wanted = -0.5 * share * RADIUS * (FOCUS - vergence) / CORNER
        np.testing.assert_allclose(away, (wanted, 0.0), atol=2e-3 * abs(wanted))
        assert np.abs(moved(lens, seen, vergence, (0.0, 1.0))).max() < 1e-6


def test_an_even_world_stays_even():
    light = tables(ArtistLens(1.0, 1.0, 1.0, 1.0, 1.0)).light(np.array([[0.0, RADIUS], [0.0, 0.0]]))
    np.testing.assert_allclose(light, 1.0, atol=1e-6)


def test_beams_of_discs_land_where_samples_do():
    lens = ArtistLens(2.0, -1.0, 0.5, 1.0, 0.4)
    beams = ArtistBeams(lens, opening_at(2.8), CORNER, RADIUS, FOCUS, 0.9 * HALF[1])
    field = FIELDS - 2
    seen = np.array([0.0, beams.tangents[field]])
    grids, centers = beams.grids(field, [0.2], 0.0)
    (grid,) = grids
    for row, column in ((30, 10), (150, 60), (100, 90)):
        place = -np.array([grid.stop_x[row, column], grid.stop_y[row, column]])
        wanted = moved(lens, seen, 0.2, place, 2.8) * CORNER + place * RADIUS * (FOCUS - 0.2)
        found = np.array([grid.x[row, column], grid.y[row, column]]) + (0.0, centers[0])
        np.testing.assert_allclose(found, wanted, atol=2e-5)


def test_no_strength_is_a_thin_lens():
    assert ArtistLens().is_plain and not ArtistLens(swirl=0.1).is_plain
