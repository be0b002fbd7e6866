"""Measures of likeness: what the noise of references has no part in."""

import numpy as np
import pytest

from benchmarks.referees.picture_metrics import compare, compare_with_two


@pytest.fixture(scope="module")
def truth():
    rows, columns = np.mgrid[0:120, 0:160]
    waves = 0.3 + 0.1 * np.sin(columns / 9.0) * np.cos(rows / 7.0) + 0.2 * (columns > 80)
    return waves[..., None] * np.array([1.0, 0.8, 0.6])


def test_noise_of_references_does_not_count(truth):
    rng = np.random.default_rng(5)
    first, second = (truth + rng.normal(0.0, 0.02, truth.shape) for _ in range(2))
    # Moved by half a pixel, which a picture without noise is judged by.
    moved = 0.5 * (truth + np.roll(truth, 1, axis=1))
    moved[:, 80:82] += 0.05
    for picture in (truth, moved):
        expected = compare(picture, truth)["ssim_srgb"]
        found = compare_with_two(picture, first, second)
        assert abs(found["ssim_srgb"] - expected) < 0.01
        assert compare(picture, 0.5 * (first + second))["ssim_srgb"] < expected - 0.1
        assert found["energy"] == pytest.approx(1.0, abs=0.01)


def test_without_noise_it_is_the_usual_measure(truth):
    blurred = sum(np.roll(truth, shift, axis=1) for shift in range(-3, 4)) / 7.0
    expected, found = compare(blurred, truth), compare_with_two(blurred, truth, truth)
    assert found["ssim_srgb"] == pytest.approx(expected["ssim_srgb"], abs=1e-6)
    assert found["ssim_tile"] == pytest.approx(expected["ssim_tile"], abs=1e-6)


def test_noise_of_the_picture_counts(truth):
    rng = np.random.default_rng(6)
    noisy = [truth + rng.normal(0.0, 0.02, truth.shape) for _ in range(3)]
    expected = compare(noisy[0], truth)["ssim_srgb"]
    assert compare_with_two(*noisy)["ssim_srgb"] == pytest.approx(expected, abs=0.01)
