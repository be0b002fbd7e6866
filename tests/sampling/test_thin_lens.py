import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.errors import FocusError
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import (
    ThinLens,
    aperture_radius,
    coc_radius_px,
    depth_of_field,
)

LENS = ThinLens(0.025, 5.0)


def test_a_50_mm_lens_at_f_2_has_a_radius_of_12_5_mm():
    assert aperture_radius(0.05, 2.0) == pytest.approx(0.0125)


def test_coc_is_negative_in_front_of_the_focus_and_bounded_behind_it():
    coc = coc_radius_px(np.array([1.0, 5.0, 1e9]), LENS, 1000.0)
    assert coc[0] < 0 and coc[1] == 0
    assert coc[2] == pytest.approx(1000.0 * 0.025 / 5.0)


@given(st.floats(0.1, 1e4), st.floats(0.1, 1e4))
def test_picture_and_object_space_circles_agree(depth, focus):
    lens = ThinLens(0.03, focus)
    picture = coc_radius_px(depth, lens, 800.0)
    # Of the cone from the lens to the point in focus, at the depth.
    in_space = 0.03 * (depth - focus) / focus
    assert picture == pytest.approx(800.0 / depth * in_space, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("focus", [0.0, -1.0, math.nan, math.inf])
def test_an_impossible_focus_distance_is_refused(focus):
    with pytest.raises(FocusError, match="focus distance"):
        ThinLens(0.02, focus)


@pytest.mark.parametrize("f_number", [0.0, -2.0, math.nan, math.inf])
def test_an_impossible_f_number_is_refused(f_number):
    with pytest.raises(FocusError, match="f-stop"):
        aperture_radius(0.05, f_number)


def test_an_impossible_iris_ratio_is_refused():
    with pytest.raises(FocusError, match="ratio"):
        ThinLens(0.02, 5.0, Iris(ratio=0.0))


@pytest.mark.parametrize("orthographic", [False, True])
def test_limits_of_the_depth_of_field_have_the_acceptable_blur(orthographic):
    blur = depth_of_field(LENS, 1000.0, orthographic)
    near, far = blur.limits(2.0)
    assert blur.diameter(near) == pytest.approx(-2.0)
    assert blur.diameter(far) == pytest.approx(2.0)
    if not orthographic:
        depth = np.array([1.0, 4.0, 50.0])
        assert blur.diameter(depth) == pytest.approx(2.0 * coc_radius_px(depth, LENS, 1000.0))


def test_from_the_hyperfocal_distance_on_there_is_no_far_limit():
    blur = depth_of_field(LENS, 1000.0)
    hyperfocal = blur.reach / blur.focus_distance
    assert math.isinf(blur.limits(hyperfocal * 1.001)[1])
    assert math.isfinite(blur.limits(hyperfocal * 0.999)[1])
    assert depth_of_field(ThinLens(0.0, 5.0), 1000.0).limits(1.0) == (0.0, math.inf)
