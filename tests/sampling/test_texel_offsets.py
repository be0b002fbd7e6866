"""Places in the pixel for look-ups by the nearest texel: with a texel's box they are the filter."""

import numpy as np
import pytest

from addon.sampling.pixel_filter import filter_density, texel_offsets
from addon.sampling.sequence import subsample_places

_GRID = np.linspace(-4.0, 4.0, 1601)


def _share_below(kind, size_px):
    """Share of places below each of the grid's, each spread over a texel."""
    middle = (np.arange(20000) + 0.5) / 20000
    places = texel_offsets(np.stack([middle, middle], axis=-1), kind, size_px)[:, 0]
    return np.array([np.clip(x - places + 0.5, 0.0, 1.0).mean() for x in _GRID])


# Boxes of other widths are met to a few hundredths, and filters hardly wider than a texel, too.
@pytest.mark.parametrize(
    ("kind", "size_px", "tolerance"),
    [
        ("BOX", 1.0, 1e-3),
        ("BOX", 2.0, 1e-3),
        ("BOX", 3.0, 1e-3),
        ("BOX", 1.5, 0.06),
        ("BOX", 2.7, 0.06),
        ("BLACKMAN_HARRIS", 1.2, 0.025),
        ("BLACKMAN_HARRIS", 1.5, 0.005),
        ("BLACKMAN_HARRIS", 2.0, 0.001),
        ("BLACKMAN_HARRIS", 4.0, 0.001),
    ],
)
def test_with_a_texel_they_are_the_filter(kind, size_px, tolerance):
    expected = np.cumsum(filter_density(_GRID, kind, size_px)) * (_GRID[1] - _GRID[0])
    # The cells of the sum are half a cell off.
    expected = np.interp(_GRID, _GRID + 0.5 * (_GRID[1] - _GRID[0]), expected)
    assert np.abs(_share_below(kind, size_px) - expected).max() < tolerance + 0.0035 / size_px


@pytest.mark.parametrize(("kind", "size_px"), [("BOX", 0.3), ("BLACKMAN_HARRIS", 1.0)])
def test_a_filter_narrower_than_a_texel_looks_at_the_centre(kind, size_px):
    assert np.allclose(texel_offsets(np.random.default_rng(1).random((9, 2)), kind, size_px), 0.0)


def test_the_subsamples_of_one_sample_and_of_all_are_spread_evenly():
    counts = np.full(32, 4)
    places = subsample_places(counts, "BLACKMAN_HARRIS", 1.5)
    # Independent ones would be 0.3 / sqrt(4) = 0.15 off with four, and 0.026 with 128; measured
    # 0.10 and 0.014.
    assert np.sqrt(np.square(places.mean(axis=1)).mean()) < 0.12
    assert np.abs(places.mean(axis=(0, 1))).max() < 0.02


def test_places_do_not_depend_on_what_samples_follow():
    counts = np.array([3, 5, 0, 4])
    more = subsample_places(np.append(counts, [9, 2]), "BOX", 2.0, seed=3)
    few = subsample_places(counts, "BOX", 2.0, seed=3)
    for sample, count in enumerate(counts):
        assert np.array_equal(few[sample, :count], more[sample, :count])
