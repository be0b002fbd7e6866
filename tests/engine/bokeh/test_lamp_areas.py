"""The areas that lamps have in the raster of the search."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from addon.engine.bokeh.lamp_areas import lamp_areas
from tests.gpu.conftest import orthographic, perspective, triangles_snapshot

WIDTH, HEIGHT = 96, 64
SIZE = (WIDTH, HEIGHT)
TRIANGLE = np.array([[-0.1, -0.1, -8.0], [0.3, -0.1, -8.0], [-0.1, 0.1, -8.0]])
WHITE = (5.0, 5.0, 5.0)


def measure(corners, projection=None, surfaces=None, world=None, lens=0.05):
    content = triangles_snapshot(corners, [WHITE] * len(corners), WIDTH, HEIGHT).content
    if world is not None:
        instances = replace(content.instances, world=np.asarray(world, np.float32))
        content = replace(content, instances=instances)
    surfaces = {(i, 0) for i in range(len(corners))} if surfaces is None else surfaces
    projection = perspective(WIDTH, HEIGHT) if projection is None else projection
    plan = SimpleNamespace(
        view=np.eye(4),
        focus_distance=4.0,
        lens_extent=np.full(2, lens),
        orthographic=projection[3, 3] == 1.0,
    )
    return lamp_areas(content, surfaces, plan, projection, SIZE)


@pytest.mark.parametrize("projection", [orthographic, perspective])
def test_a_lamp_has_the_area_of_its_triangle_as_the_raster_shows_it(projection):
    matrix = projection(WIDTH, HEIGHT)
    found = measure([TRIANGLE], matrix)
    # Legs of 0.4 and 0.2 at a right angle, seen from the front.
    away = 8.0 if projection is perspective else 1.0
    legs = np.array([0.4, 0.2]) * np.diag(matrix)[:2] * np.array(SIZE) / 2.0 / away
    assert found.rows.tolist() == [0]
    # Positions are float32.
    assert found.areas[0] == pytest.approx(legs.prod() / 2.0, rel=1e-5)
    np.testing.assert_allclose(found.upper[0] - found.lower[0], legs, rtol=1e-5)


def test_the_area_follows_the_instance_and_does_not_ask_which_way_it_faces():
    whole = measure([TRIANGLE]).areas[0]
    far = np.eye(4)
    far[2, 3] = -8.0
    assert measure([TRIANGLE], world=[far]).areas[0] == pytest.approx(whole / 4.0, rel=1e-5)
    turned = np.diag([-1.0, 1.0, 1.0, 1.0])
    assert measure([TRIANGLE], world=[turned]).areas[0] == pytest.approx(whole, rel=1e-5)


def test_what_reaches_behind_the_camera_is_not_measured():
    reaching = TRIANGLE.copy()
    reaching[1, 2] = 1.0
    assert measure([TRIANGLE, reaching]).rows.tolist() == [0]


def test_only_the_surfaces_that_are_asked_for_count():
    assert measure([TRIANGLE, TRIANGLE], surfaces={(1, 0)}).rows.tolist() == [1]
    assert measure([TRIANGLE], surfaces=set()).rows.tolist() == []


def test_a_tile_counts_what_lies_in_it_and_cannot_be_missed():
    found = measure([TRIANGLE])
    x, y = np.floor(found.lower[0]).astype(int).tolist()
    tile = (x, y, 20, 20)
    areas = found.in_tile(tile, 8, 3)
    assert areas.tolist() == [pytest.approx(found.areas[0] * 64.0), 0.0, 0.0]
    # Cut by the tile's edge; thinner than two texels; longer than a thousand.
    assert not found.in_tile((x + 1, y, 20, 20), 8, 3).any()
    assert found.any_cut([(x, y, 1, 20), (x + 1, y, 19, 20)], 8, areas)
    assert not found.any_cut([tile, (x + 20, y, 20, 20)], 8, areas)
    assert not found.any_cut([tile], 8, areas)
    assert not found.in_tile(tile, 1, 3).any()
    assert not found.in_tile(tile, 512, 3).any()


def test_light_grows_by_what_the_rest_of_the_lens_sees_besides():
    assert measure([TRIANGLE]).growths(2).tolist() == [1.0, 1.0]
    # Its plane passes the middle of the lens at 0.02 m.
    steep = np.array([[0.02, -0.1, -8.0], [0.02, -0.1, -12.0], [0.02, 0.1, -8.0]])
    growths = [measure([steep], lens=lens).growths(1)[0] for lens in (0.01, 0.03, 0.04, 0.2)]
    assert growths[0] == 1.0
    # A larger lens sees more of it, up to the limit.
    assert 1.0 < growths[1] < growths[2] < growths[3] == 2.0
    # Where the middle sees nothing, there is nothing to grow.
    assert measure([steep - [0.02, 0.0, 0.0]]).growths(1).tolist() == [1.0]
