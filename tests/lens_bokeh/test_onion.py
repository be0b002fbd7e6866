import numpy as np
import pytest

from addon.errors import InputError
from addon.lens_bokeh.look.onion import (
    OnionRings,
    transmission,
)
from addon.lens_bokeh.openings.masks import texel_centres

POINTS = texel_centres(256)


def test_rings_are_round_and_as_deep_as_asked():
    rings = OnionRings(contrast=0.2, pitch=0.1, irregularity=0.0)
    values = transmission(rings, POINTS)
    assert np.allclose(values, values.T) and np.allclose(values, values[::-1])
    assert values.max() == pytest.approx(1.2, abs=2e-3)
    assert values.min() == pytest.approx(0.8, abs=2e-3)


def test_even_rings_repeat_with_their_pitch():
    rings = OnionRings(contrast=0.2, pitch=0.1, irregularity=0.0)
    line = np.stack([np.linspace(0.0, 0.8, 81), np.zeros(81)], axis=-1)
    values = transmission(rings, line)
    assert np.allclose(values[:-10], values[10:], atol=1e-9)


def test_irregular_rings_are_no_jump_anywhere():
    line = np.stack([np.linspace(0.0, 1.2, 4001), np.zeros(4001)], axis=-1)
    values = transmission(OnionRings(0.3, 0.05, 1.0, seed=3), line)
    # Slope of the cosine plus those of depth and phase: a few times 2 pi contrast / pitch.
    assert np.abs(np.diff(values)).max() < 3 * 2 * np.pi * 0.3 / 0.05 * 1.2 / 4000
    assert values.min() >= 0.7 and values.max() <= 1.3


def test_the_centre_moves_with_the_field():
    rings = OnionRings(0.2, 0.2, 0.0, shift=-0.5)
    values = transmission(rings, POINTS, (0.4, 0.0))
    centred = transmission(OnionRings(0.2, 0.2, 0.0), POINTS + (0.2, 0.0))
    assert np.allclose(values, centred)


def test_rings_finer_than_texels_fade():
    rings = OnionRings(0.2, 0.01, 0.0)
    assert np.all(transmission(rings, POINTS, width=0.02) == 1.0)


def test_values_out_of_range_are_refused():
    for wrong in (dict(contrast=1.5), dict(pitch=0.0), dict(irregularity=-1.0)):
        with pytest.raises(InputError, match=next(iter(wrong))):
            OnionRings(**wrong)
