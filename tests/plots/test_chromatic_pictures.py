"""Small pictures of field maps: what is bright, what turns its colour, and what a pole leaves."""

import numpy as np
import pytest

from addon.plots.chromatic_pictures import encoded, map_curve, map_disc, map_range, spectrum_colors
from addon.sampling.field_maps import FIELD_PRESETS, FieldMap

MAPS = {f"{name} {i}": maps[1 + i] for name, maps in FIELD_PRESETS.items() for i in range(2)}


@pytest.mark.parametrize("name", MAPS)
def test_every_map_has_a_picture(name):
    shown = map_range(MAPS[name])
    assert shown[0] <= 0.0 <= shown[1] and shown[0] < shown[1]
    for picture in (map_curve(MAPS[name], shown, 64), map_disc(MAPS[name], shown, 1.5, 64)):
        assert picture.shape == (64, 64, 4) and picture.dtype == np.float32
        assert picture.min() >= 0.0 and picture.max() <= 1.0
        # Multiplied by alpha.
        assert (picture[..., :3] <= picture[..., 3:] + 1e-6).all()


def test_the_range_is_that_of_the_map_but_a_pole_is_cut_off():
    assert map_range(FieldMap()) == (0.0, 1.0)
    assert map_range(FieldMap("COS_T")) == pytest.approx((-1.0, 1.0), abs=0.01)
    low, high = map_range(FieldMap("ONE_MINUS", "RECIPROCAL"))
    assert low == 0.0 and 5.0 < high < 20.0
    assert map_range(FieldMap("CURVE", curve_f=(0.0, 0.0))) == (0.0, 1.0)


def test_the_curve_goes_through_its_values():
    size = 100
    picture = map_curve(FieldMap("T2"), (0.0, 1.0), size)[..., :3].min(axis=-1)
    margin = 0.06 * size
    inner = size - 1 - 2 * margin
    for t in (0.1, 0.5, 0.9):
        column = round(margin + t * inner)
        at = (column - margin) / inner
        assert picture[:, column].argmax() == pytest.approx(margin + inner * (1 - at**2), abs=1.5)


def test_the_disc_is_dark_at_zero_orange_above_and_blue_below():
    disc = map_disc(FieldMap("T_COS_THETA"), (-1.0, 1.0), 1.0, 101)
    middle, right, left = disc[50, 50], disc[50, 90], disc[50, 10]
    assert middle[:3].max() < 0.05
    assert right[0] > 0.5 > right[2]
    assert left[2] > 0.5 > left[0]
    assert disc[0, 0, 3] == 0.0


def test_theta_turns_anticlockwise_and_the_top_of_the_picture_is_up():
    def up(_t, theta):
        return np.sin(theta) + 0.0 * _t

    disc = map_disc(up, (-1.0, 1.0), 1.0, 101)
    assert disc[15, 50, 0] > 0.5 > disc[85, 50, 0]


def test_the_frame_touches_the_rim_with_its_corners():
    disc = map_disc(lambda t, theta: 0.0 * t + 0.0 * theta, (0.0, 1.0), 2.0, 201)
    rows, columns = np.nonzero(disc[..., 0] > 0.5)
    x, y = (columns - 100) / (0.47 * 201), (rows - 100) / (0.47 * 201)
    assert np.abs(x).max() == pytest.approx(2 / np.sqrt(5), abs=0.02)
    assert np.abs(y).max() == pytest.approx(1 / np.sqrt(5), abs=0.02)


def test_a_spectrum_goes_from_violet_to_red():
    colors = spectrum_colors((380.0, 780.0))
    assert colors.shape == (401, 3) and colors.min() >= 0.0 and colors.max() <= 1.0
    assert colors[450 - 380].argmax() == 2
    assert colors[540 - 380].argmax() == 1
    assert colors[640 - 380].argmax() == 0
    assert encoded(np.array([0.0, 0.5, 1.0])) == pytest.approx([0.0, 0.735, 1.0], abs=1e-3)
