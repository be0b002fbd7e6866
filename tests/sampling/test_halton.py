import numpy as np
import pytest

from addon.sampling.halton import halton, radical_inverse


def test_radical_inverse_in_base_2_and_3_has_the_textbook_values():
    # Halton 1960; any textbook on quasi-Monte-Carlo prints these.
    assert radical_inverse(np.arange(8), 2).tolist() == [
        0,
        0.5,
        0.25,
        0.75,
        0.125,
        0.625,
        0.375,
        0.875,
    ]
    expected = np.array([0, 1 / 3, 2 / 3, 1 / 9, 4 / 9, 7 / 9])
    assert np.allclose(radical_inverse(np.arange(6), 3), expected, atol=1e-15)


def test_a_full_power_of_the_base_fills_every_stratum_once():
    points = halton(0, 49, (7,))[:, 0]
    assert sorted(np.floor(points * 49 + 1e-9).astype(int)) == list(range(49))


@pytest.mark.parametrize("first", [0, 137, 4096])
def test_any_contiguous_run_is_nearly_uniform(first):
    points = halton(first, 98, (2, 7))
    counts, _, _ = np.histogram2d(*points.T, bins=(2, 7), range=((0, 1), (0, 1)))
    # 98 points over 14 boxes: 7 each; a run cuts at most one period of each base.
    assert np.abs(counts - 7).max() <= 2


def test_runs_join_to_the_whole_sequence():
    whole = halton(0, 20, (2, 7), 0.5)
    assert np.array_equal(
        np.concatenate([halton(0, 8, (2, 7), 0.5), halton(8, 12, (2, 7), 0.5)]), whole
    )


def test_a_shift_keeps_points_in_the_unit_square():
    points = halton(0, 1000, (2, 7), (0.9, 0.99))
    assert points.min() >= 0 and points.max() < 1
