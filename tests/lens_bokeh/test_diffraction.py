import numpy as np
import pytest

from addon.errors import InputError
from addon.lens_bokeh.look import diffraction
from addon.lens_bokeh.look.diffraction import (
    chromatic_pattern,
    diffraction_pattern,
    fresnel_number,
    pattern_extent,
)
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.masks import iris_mask

ROUND = BladedIris()


def profile(pattern, extent):
    """Values along x through the middle, and the places."""
    size = len(pattern)
    x = (np.arange(size) + 0.5) * (2.0 * extent / size) - extent
    return x, pattern[size // 2 - 1 : size // 2 + 1].mean(axis=0)


@pytest.mark.parametrize("number", [0.02, 0.05])
def test_small_fresnel_numbers_give_the_airy_pattern(number):
    extent = 1.0 / number
    x, line = profile(diffraction_pattern(ROUND, number, 400, extent), extent)
    # First zero of the Airy disc: 1.22 lambda z / D = 0.61 / N in units of the radius.
    first = x[(x > 0.4 / number) & (x < 0.8 / number)]
    dip = first[np.argmin(line[(x > 0.4 / number) & (x < 0.8 / number)])]
    assert dip * number == pytest.approx(0.6098, abs=0.01)  # a texel is 0.005 of that
    # Its value in the middle is (pi N)^2, less a part in 500 for N = 0.05.
    assert line.max() == pytest.approx((np.pi * number) ** 2, rel=4e-3)


@pytest.mark.parametrize("number", [3e4, 1e6])
def test_large_fresnel_numbers_give_the_geometric_shadow(number):
    iris, size, extent = BladedIris(6, 0.2, 0.3), 64, 1.2
    pattern = diffraction_pattern(iris, number, size, extent)
    shadow = iris_mask(iris, size, extent)
    # Fringes are narrower than a third of a texel; those nearest the rim are left.
    assert np.sqrt(np.mean((pattern - shadow) ** 2)) < 0.02
    inner = iris_mask(iris, size, extent * 1.15) == 1.0
    assert pattern[inner].mean() == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("number", [0.5, 1.0, 3.0, 6.0, 10.5, 25.5])
def test_intensity_on_the_axis_is_that_of_fresnel_zones(number):
    pattern = diffraction_pattern(ROUND, number, 3, 0.003)
    # A round opening of N zones: 4 sin^2(pi N / 2). Drawn in texels its radius is right to 4e-4,
    # which shifts the phase by 2 pi N times that.
    expected = 4.0 * np.sin(np.pi * number / 2.0) ** 2
    assert pattern[1, 1] == pytest.approx(expected, abs=0.01 + 0.006 * number)


def test_straight_edge_has_the_fresnel_overshoot():
    # Far from the other rim, a straight edge: first maximum 1.370, at 1.217 sqrt(1 / (2 N))
    # inside, and a quarter on the edge (Born and Wolf, Principles of Optics, 8.7.3).
    number, rim = 400.0, np.sqrt(0.5)
    pattern = diffraction_pattern(BladedIris(4), number, 600, 0.9)
    # Averaged along the edge, over which the other rims' ripple goes up and down.
    x, _ = profile(pattern, 0.9)
    line = pattern[300 - 100 : 300 + 100].mean(axis=0)
    right = x > 0.4
    assert line[right].max() == pytest.approx(1.370, abs=0.03)
    # A texel is 0.003.
    first = 1.217 / np.sqrt(2.0 * number)
    assert rim - x[right][np.argmax(line[right])] == pytest.approx(first, abs=0.004)
    assert np.interp(rim, x, line) == pytest.approx(0.25, abs=0.03)


def test_both_forms_of_the_transform_agree_where_they_meet():
    iris, number = BladedIris(5, 0.3, 0.1), diffraction._LARGEST_NUMBER_OF_MATRIX
    by_matrix = diffraction._by_matrix(iris, number, 128, 1.2)
    by_convolution = diffraction._by_convolution(iris, number, 128, 1.2)
    # Copies of the opening in the FFT's window ripple by less than 1 %; rims are drawn on
    # different grids.
    assert np.sqrt(np.mean((by_matrix - by_convolution) ** 2)) < 0.006
    assert np.abs(by_matrix - by_convolution).max() < 0.06


@pytest.mark.parametrize("number", [1.0, 8.0, 40.0, 200.0])
def test_energy_of_the_opening_is_kept(number):
    extent = pattern_extent(number)
    iris = BladedIris(7, 0.5)
    energy = diffraction_pattern(iris, number, 200, extent).sum() * (2.0 * extent / 200) ** 2
    # Some is always outside a finite picture: corners of blades throw far.
    assert 0.96 < energy / iris.area < 1.003


def test_an_asymmetric_iris_keeps_its_side():
    wedge = BladedIris(3, 0.0, 0.0)  # first side towards +x, a corner towards -x
    pattern = diffraction_pattern(wedge, 50.0, 128, 1.3)
    x, line = profile(pattern, 1.3)
    assert line[x < -0.6].sum() > 3.0 * line[x > 0.6].sum()


def test_red_rings_are_wider_than_blue_ones():
    weights = ((1.0, 0.0), (0.0, 1.0))
    pattern = chromatic_pattern(ROUND, 0.05, 200, 30.0, (650.0, 450.0), weights)
    widths = []
    for channel in range(2):
        x, line = profile(pattern[..., channel], 30.0)
        widths.append(x[(x > 0) & (line < line.max() / 2)][0])
    assert widths[0] / widths[1] == pytest.approx(650.0 / 450.0, rel=0.06)  # a texel in five


def test_fresnel_number_of_a_defocus():
    # Radius 10 mm, image 50 mm behind the pupil, sensor 0.5 mm behind it.
    number = fresnel_number(10.0, 50.0, 50.5, 500.0)
    assert number == pytest.approx(100.0 * (1 / 50.0 - 1 / 50.5) / 5e-4)
    assert fresnel_number(10.0, 50.0, 50.0, 500.0) == 0.0


def test_no_defocus_is_refused():
    for wrong in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(InputError, match="Fresnel"):
            diffraction_pattern(ROUND, wrong, 16)
