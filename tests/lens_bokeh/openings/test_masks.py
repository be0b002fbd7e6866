import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.errors import InputError
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.masks import iris_mask, texel_centres
from addon.lens_bokeh.openings.pictures import PictureIris
from addon.sampling.halton import halton
from addon.sampling.iris import Iris, iris_points


def drawn_area(iris, size=256, extent=1.05):
    return iris_mask(iris, size, extent).sum() * (2.0 * extent / size) ** 2


@given(st.integers(3, 32), st.floats(0.0, 1.0), st.floats(-7.0, 7.0))
def test_area_of_the_mask_is_that_of_the_opening(blades, curvature, rotation):
    iris = BladedIris(blades, curvature, rotation)
    # Rims are straight within a quarter of a texel: errors are near 1e-4 of the area.
    assert drawn_area(iris, 128) == pytest.approx(iris.area, rel=5e-4)


@pytest.mark.parametrize("blades", [3, 6, 32])
def test_area_runs_from_the_polygon_to_the_circle(blades):
    half = np.pi / blades
    straight = BladedIris(blades).area
    assert straight == pytest.approx(blades * np.sin(half) * np.cos(half), rel=1e-14)
    assert BladedIris(blades, 1.0).area == pytest.approx(np.pi, rel=1e-12)
    areas = [BladedIris(blades, c).area for c in np.linspace(0.0, 1.0, 11)]
    assert np.all(np.diff(areas) > 0.0)
    # Nearly straight blades make no jump, nor do those where the series ends.
    near = [BladedIris(blades, c / np.sin(half)).area for c in (0.9999e-3, 1.0001e-3)]
    assert near[0] == pytest.approx(near[1], rel=1e-6)
    assert BladedIris(blades, 1e-9).area == pytest.approx(straight, rel=1e-8)


@pytest.mark.parametrize("blades", [3, 5, 8])
@pytest.mark.parametrize("rotation", [0.0, 0.4])
def test_straight_blades_hold_the_samples_of_the_thin_lens(blades, rotation):
    iris = BladedIris(blades, 0.0, rotation)
    points = iris_points(halton(1, 4000, (2, 7)), Iris(blades, rotation))
    assert iris.clearance(points).min() > -1e-12
    # And no smaller opening does.
    assert iris.clearance(points * 1.02).min() < 0.0


def test_corners_lie_on_the_unit_circle_and_full_curvature_is_round():
    iris = BladedIris(6, 0.3, 0.2)
    turn = 0.2 + np.pi / 6 + np.arange(6) * np.pi / 3
    corners = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    assert np.allclose(iris.clearance(corners), 0.0, atol=1e-12)
    points = texel_centres(33, 1.5)
    assert np.allclose(BladedIris(6, 1.0).clearance(points), BladedIris().clearance(points))


def test_a_round_picture_is_the_round_iris():
    round_mask = iris_mask(BladedIris(), 256)
    picture = PictureIris(round_mask)
    assert picture.area == pytest.approx(np.pi, rel=1e-4)
    assert drawn_area(picture) == pytest.approx(np.pi, rel=1e-3)
    # Both are blurred by a texel of 64 at the rim, differently.
    assert np.abs(iris_mask(picture, 64) - iris_mask(BladedIris(), 64)).mean() < 2e-3


def test_a_picture_turns_anticlockwise_and_keeps_its_shape():
    picture = np.zeros((20, 40))
    picture[:, 30:] = 1.0  # the right quarter
    mask = iris_mask(PictureIris(picture, np.pi / 2), 40)
    y, x = np.argwhere(mask > 0.5).mean(axis=0)
    assert y == pytest.approx(34.5, abs=0.5) and x == pytest.approx(19.5, abs=0.5)


def test_negative_blades_and_black_pictures_are_refused():
    for blades in (-3, 1, 2, 33):
        with pytest.raises(InputError, match="blades"):
            BladedIris(blades)
    with pytest.raises(InputError, match="curvature"):
        BladedIris(5, 1.5)
    with pytest.raises(InputError, match="black"):
        PictureIris(np.zeros((4, 4)))
    with pytest.raises(InputError, match="finite"):
        PictureIris(np.full((4, 4), np.nan))
    with pytest.raises(InputError, match="shape"):
        PictureIris(np.ones(4))
