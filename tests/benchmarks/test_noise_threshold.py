"""The noise of a reference is told from its halves, and what it decides is not decided."""

import numpy as np
import pytest

from benchmarks.tools.noise_threshold import judged, noise_of_mean


# Independent halves, and such as samples of low discrepancy make: their errors cancel.
@pytest.mark.parametrize("power", [1.0, 1.25, 1.5])
def test_the_noise_of_a_mean_follows_from_its_halves(power):
    rng = np.random.default_rng(2)
    correlation = 2.0 ** (1.0 - power) - 1.0
    first, other = rng.standard_normal((2, 100000))
    second = correlation * first + np.sqrt(1.0 - correlation**2) * other
    apart, whole = np.var(first - second), np.var(0.5 * (first + second))
    # A whole has 2^-p of the variance of a half.
    assert whole == pytest.approx(2.0**-power, rel=0.02)
    assert noise_of_mean(apart, power) == pytest.approx(whole, rel=0.02)


def test_what_the_reference_decides_is_not_decided():
    assert judged(0.9, 1.0, False) == "ok"
    assert judged(1.4, 1.5, False) == "above"
    assert judged(0.4, 0.45, False) == "below"
    assert judged(0.4, 0.45, True) == "ok"
    assert judged(0.4, 0.6, False) == "not decided"
    assert judged(0.6, 1.7, False) == "not decided"
