"""What levels do themselves is told from the noise of the samples that they move."""

import numpy as np
import pytest

from benchmarks.tools.levels_of_detail import decibels, decided, own_share

_HEIGHT, _WIDTH = 135, 240


def _differences(share, noise, seeds):
    """Differences of several seeds: the same in all, and noise that spreads over some pixels."""
    rng = np.random.default_rng(5)
    own = share * rng.standard_normal((_HEIGHT, _WIDTH, 1)) * np.ones(3)
    spread = [rng.standard_normal((_HEIGHT + 2, _WIDTH + 2, 3)) for _ in range(seeds)]
    smooth = [
        sum(each[y : y + _HEIGHT, x : x + _WIDTH] for y in range(3) for x in range(3)) / 3.0
        for each in spread
    ]
    return [own + noise * each for each in smooth]


@pytest.mark.parametrize("seeds", [2, 4])
@pytest.mark.parametrize("share", [0.0, 0.004, 0.012])
def test_the_own_share_is_found_below_noise(share, seeds):
    found, error = own_share(_differences(share, 0.02, seeds))
    assert abs(found - share**2) < 3.0 * error
    # Noise alone is 34 dB.
    assert decibels(error) > 52.0


def test_more_seeds_decide_what_two_do_not():
    # 42 dB are 0.0079.
    assert not decided(*own_share(_differences(0.0075, 0.1, 2)))
    assert decided(*own_share(_differences(0.0, 0.02, 2)))
    assert decided(*own_share(_differences(0.012, 0.02, 2)))
