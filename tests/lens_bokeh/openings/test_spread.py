"""Lens samples and discs have one opening: where samples go is where discs are open."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.errors import InputError
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.masks import iris_mask
from addon.lens_bokeh.openings.pictures import PictureIris
from addon.lens_bokeh.openings.shapes import iris_of, opening_of, stopped_down
from addon.sampling.halton import halton
from addon.sampling.iris import Iris, iris_points
from addon.sampling.sequence import lens_samples
from addon.sampling.subsamples import subsample_offsets
from tests.lens_bokeh.openings.shapes import heart

SQUARE = halton(1, 20000, (2, 7))
GREY = np.random.default_rng(4).random((5, 8))
OPENINGS = {
    "curved": BladedIris(5, 0.4, 0.3),
    "round": BladedIris(7, 1.0, 0.3),
    "behind a stop": BladedIris(6, 0.2, -0.4, 1.02),
    "heart": PictureIris(heart(), 0.2),
    "grey": PictureIris(GREY),
    "one texel": PictureIris(np.full((1, 1), 0.3)),
    "cut by the square": PictureIris(np.ones((8, 8)), 0.6),
    "cut by the stop": PictureIris(np.ones((8, 8)), 0.6, stop=True),
}


@pytest.mark.parametrize("name", OPENINGS)
def test_samples_are_as_dense_as_the_disc_is_bright(name):
    opening = OPENINGS[name]
    points = opening.spread(SQUARE)
    assert np.abs(points).max() <= 1.0
    cells = 12
    mask = iris_mask(opening, 16 * cells).reshape(cells, 16, cells, 16).mean(axis=(1, 3))
    counts, _, _ = np.histogram2d(points[:, 1], points[:, 0], cells, [[-1, 1], [-1, 1]])
    # 20000 points of low discrepancy: random ones differ by 4 times as much.
    assert np.abs(counts / counts.sum() - mask / mask.sum()).max() < 6e-4


@given(st.integers(3, 16), st.floats(0.0, 1.0), st.floats(-4.0, 4.0), st.floats(1.0, 3.0))
def test_no_sample_is_behind_a_blade(blades, curvature, rotation, closing):
    iris = BladedIris(blades, curvature, rotation, closing)
    points = iris.spread(SQUARE[:512])
    assert iris.clearance(points).min() > -1e-9
    # And they reach the rim.
    assert iris.clearance(points * 1.15).min() < 0.0
    corner = np.hypot(*points.T).max()
    assert 0.8 < corner <= 1.0 + 1e-12


def test_samples_of_round_irises_and_straight_blades_are_what_they_were():
    for opening, plain in (
        (BladedIris(), Iris()),
        (BladedIris(5, 0.0, 0.3), Iris(5, 0.3)),
        (BladedIris(5, 0.0, 0.3, 9.0), Iris(5, 0.3)),
        (BladedIris(5, 0.2, 0.3, 1.0), Iris()),
    ):
        assert np.array_equal(opening.spread(SQUARE), iris_points(SQUARE, plain))
    assert iris_of(BladedIris(5, 0.0, 0.3), 0.3, 2.0) == Iris(5, 0.3, 2.0)
    assert iris_of(BladedIris(), 0.7) == Iris(0, 0.7)


def test_an_iris_knows_its_opening_again():
    for opening in (BladedIris(), BladedIris(6, 0.0, 0.3), *OPENINGS.values()):
        rotation = getattr(opening, "rotation", 0.0)
        assert opening_of(iris_of(opening, rotation)) == opening


def test_places_follow_one_another_as_evenly_as_over_a_round_iris():
    picture = iris_of(PictureIris(heart()))

    def unevenness(iris, count=64):
        mean = lens_samples(0, 16384, iris).mean(axis=0)
        found = lens_samples(0, count, iris, 5)
        return np.abs(found.mean(axis=0) - mean).max()

    # Random places would be off by 0.06.
    assert unevenness(picture) < max(2.0 * unevenness(Iris()), 0.02)


def test_subsamples_stay_in_the_opening():
    opening = PictureIris(heart())
    places = lens_samples(0, 16 * 5, iris_of(opening))
    offsets, counts = subsample_offsets(places[:16], places[16:])
    for place, further, count in zip(places[:16], offsets, counts, strict=True):
        assert (opening.coverage(place + further[:count], 1e-3) > 0.0).all()


def test_the_ratio_divides_the_width_of_a_picture():
    wide = iris_of(PictureIris(heart()), ratio=0.5)
    plain = iris_of(PictureIris(heart()))
    assert np.allclose(iris_points(SQUARE, wide), iris_points(SQUARE, plain) * (2.0, 1.0))


@given(st.integers(3, 32), st.floats(0.0, 1.0), st.floats(1.0, 2.0))
def test_blades_over_a_round_stop_let_through_what_the_f_number_says(blades, curvature, closing):
    iris = BladedIris(blades, curvature, 0.0, closing)
    left = np.pi / closing**2
    if iris.blade_radius == 1.0:
        # The stop is out of sight: the blades are at most as large as it.
        assert left <= BladedIris(blades, curvature).area * (1.0 + 1e-9)
        assert iris.area == pytest.approx(BladedIris(blades, curvature).area)
    else:
        assert iris.area == pytest.approx(left, rel=1e-6)


def test_blades_come_in_as_the_lens_is_stopped_down():
    def corner_and_side(closing):
        iris = BladedIris(5, 0.0, 0.0, closing)
        angles = np.linspace(0.0, np.pi / 5, 100)
        rim = [
            np.count_nonzero(iris.clearance(np.outer(np.linspace(0, 1, 1000), direction)) > 0)
            for direction in np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        ]
        return rim[-1] / 1000, rim[0] / 1000

    sides = [corner_and_side(closing)[1] for closing in (1.0, 1.05, 1.1, 1.2, 4.0)]
    assert sides[0] == pytest.approx(1.0, abs=2e-3)
    assert np.all(np.diff(sides[:4]) < 0.0)
    # Cos 36 degrees: straight blades, once the stop is out of sight.
    assert sides[3:] == pytest.approx([0.809, 0.809], abs=2e-3)
    # The circle round the opening follows from the f-number, whatever the blades are.
    assert all(corner_and_side(c)[0] == pytest.approx(1.0, abs=2e-3) for c in (1.0, 1.1, 4.0))


def test_an_opening_is_stopped_down_again():
    iris = BladedIris(5, 0.3, 0.1, 1.0)
    assert stopped_down(iris, 1.4) == BladedIris(5, 0.3, 0.1, 1.4)
    assert stopped_down(BladedIris(5), 1.4) == BladedIris(5)
    picture = PictureIris(GREY)
    assert stopped_down(picture, 1.4) is picture
    assert stopped_down(iris, None) == BladedIris(5, 0.3, 0.1)


def test_closings_and_pictures_that_leave_nothing_are_refused():
    for closing in (0.5, np.nan, np.inf):
        with pytest.raises(InputError, match="widest f-number"):
            BladedIris(5, 0.0, 0.0, closing)
    corner = np.zeros((32, 32))
    corner[0, 0] = 1.0
    assert PictureIris(corner).spread(SQUARE[:8]).max() < -0.9
    for rotation, stop in ((np.pi / 4, False), (0.0, True)):
        with pytest.raises(InputError, match="outside of the opening"):
            PictureIris(corner, rotation, stop)


def test_the_stop_of_a_real_lens_makes_a_square_round():
    assert PictureIris(np.ones((256, 256)), stop=True).area == pytest.approx(np.pi, rel=5e-3)
    assert PictureIris(np.ones((8, 8))).area == 4.0
    assert PictureIris(np.ones((8, 8)), stop=True) != PictureIris(np.ones((8, 8)))
