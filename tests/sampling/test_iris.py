import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.sampling.halton import halton
from addon.sampling.iris import Iris, concentric_disk, iris_points

SQUARE = halton(1, 20000, (2, 7))


def test_the_square_s_centre_becomes_the_lens_centre():
    assert np.array_equal(concentric_disk(np.array([0.5, 0.5])), [0.0, 0.0])


def test_disk_points_are_uniform_by_area():
    radius = np.hypot(*concentric_disk(SQUARE).T)
    assert radius.max() <= 1.0 + 1e-12
    # Area inside radius r is r^2; 20000 Halton points have a discrepancy near 1e-3.
    for r in (0.25, 0.5, 0.75):
        assert np.mean(radius < r) == pytest.approx(r * r, abs=3e-3)


@pytest.mark.parametrize("blades", [3, 4, 5, 6, 9, 16])
def test_polygon_points_are_uniform_and_inside(blades):
    points = iris_points(SQUARE, Iris(blades, 0.3))
    sides = 0.3 + 2 * np.pi * np.arange(blades) / blades
    distance = points @ np.stack([np.cos(sides), np.sin(sides)])
    inner = np.cos(np.pi / blades)
    assert distance.max() <= inner + 1e-9
    # A polygon of half the size has a quarter of the area.
    assert np.mean(distance.max(axis=1) < inner / 2) == pytest.approx(0.25, abs=3e-3)
    # A third of the area of a triangle fan lies in a third of its sides: the mean is the centre.
    assert np.abs(points.mean(axis=0)).max() < 3e-3


def test_second_moment_of_a_polygon_is_the_analytic_one():
    # Regular n-gon of circumradius 1: <x^2 + y^2> = (2 + cos(2 pi / n)) / 6.
    for blades in (3, 5, 8):
        points = iris_points(SQUARE, Iris(blades))
        expected = (2 + np.cos(2 * np.pi / blades)) / 6
        assert np.mean((points**2).sum(axis=1)) == pytest.approx(expected, rel=3e-3)


def test_one_or_two_blades_are_round():
    assert np.array_equal(iris_points(SQUARE, Iris(2)), iris_points(SQUARE, Iris(0)))


@given(st.floats(0.1, 10.0), st.integers(0, 16), st.floats(-10, 10))
def test_the_ratio_divides_the_width_only(ratio, blades, rotation):
    plain = iris_points(SQUARE[:64], Iris(blades, rotation))
    squeezed = iris_points(SQUARE[:64], Iris(blades, rotation, ratio))
    assert np.allclose(squeezed * [ratio, 1.0], plain, rtol=1e-12)
