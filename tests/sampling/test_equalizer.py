"""The spectral equalizer."""

import numpy as np
import pytest

from addon.errors import InputError
from addon.sampling.equalizer import EQUALIZER_PRESETS, FLAT, SpectralEqualizer, band


def test_straight_between_its_points_and_level_beyond():
    curve = SpectralEqualizer((400.0, 500.0, 700.0), (0.0, 1.0, 0.5))
    np.testing.assert_allclose(curve([300.0, 425.0, 600.0, 800.0]), [0.0, 0.25, 0.75, 0.5])


def test_band_is_as_wide_as_said():
    passed = band(550.0, 40.0, 4.0)
    np.testing.assert_allclose(passed([500, 530, 550, 570, 600]), [0, 0.5, 1, 0.5, 0], atol=1e-12)
    places = np.linspace(380.0, 780.0, 40001)
    assert passed(places).mean() * 400.0 == pytest.approx(40.0, rel=1e-3)
    assert band(550.0, 40.0, floor=0.1)(400.0) == 0.1


def test_presets_are_curves_over_the_spectrum():
    places = np.linspace(380.0, 780.0, 401)
    for label, curve in EQUALIZER_PRESETS.values():
        assert label and np.all(curve(places) >= 0.0) and curve(places).max() == 1.0
    flat = [name for name, (_, curve) in EQUALIZER_PRESETS.items() if curve.is_flat]
    assert flat == ["FLAT"] and EQUALIZER_PRESETS["FLAT"][1] == FLAT


@pytest.mark.parametrize(
    "places, weights, message",
    [
        ((400.0,), (1.0,), "two or more"),
        ((400.0, 500.0), (1.0,), "as many"),
        ((500.0, 400.0), (1.0, 1.0), "rise"),
        ((400.0, 500.0), (1.0, -0.1), "negative"),
    ],
)
def test_what_is_no_curve_is_refused(places, weights, message):
    with pytest.raises(InputError, match=message):
        SpectralEqualizer(places, weights)
