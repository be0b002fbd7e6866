"""The split of light into what lens samples draw and what is splatted."""

import numpy as np
import pytest

from addon.sampling.highlights import (
    amplify,
    highlight_base,
    highlight_light,
    highlight_share,
    least_coc,
)


def radiances(seed=5, count=200):
    """Return radiances over nine decades, some of them black."""
    rng = np.random.default_rng(seed)
    return np.concatenate([10.0 ** rng.uniform(-4, 5, (count, 3)), np.zeros((1, 3))])


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_base_and_highlight_add_up_to_the_whole(share):
    radiance = radiances()
    base = highlight_base(radiance, np.full(len(radiance), share), 1.0)
    # Rounding of doubles.
    np.testing.assert_allclose(
        base + share * highlight_light(radiance, 1.0), radiance, rtol=1e-14, atol=0
    )


def test_nothing_below_the_threshold_is_splatted():
    radiance = radiances()
    dark = radiance.max(axis=1) <= 2.0
    assert (highlight_light(radiance, 2.0)[dark] == 0.0).all()
    assert (highlight_light(radiance, 2.0)[~dark].max(axis=1) > 0.0).all()


def test_base_keeps_the_colour_and_ends_at_the_threshold():
    radiance = radiances()
    base = highlight_base(radiance, np.ones(len(radiance)), 1.0)
    assert base.max() <= 1.0 + 1e-15
    cross = np.cross(base, radiance)
    assert np.abs(cross).max() <= 1e-12 * np.abs(radiance).max()


def test_base_of_single_precision_is_exact_for_very_bright_light():
    radiance = np.array([[1e5, 3e4, 0.0]], np.float32)
    base = highlight_base(radiance, np.ones(1, np.float32), np.float32(1.0))
    assert (base == 0.0).all()
    half = highlight_base(radiance, np.full(1, 0.5, np.float32), np.float32(1.0))
    assert half[0] == pytest.approx(0.5 * radiance[0], rel=1e-6)


def test_samples_keep_less_of_brighter_light_and_nothing_of_lamps():
    grey = np.linspace(0.0, 5.0, 501)[:, None] * np.ones(3)
    kept = highlight_base(grey, np.ones(501), 2.0)[:, 0]
    np.testing.assert_allclose(kept[:201], grey[:201, 0])
    assert (np.diff(kept[200:401]) < 0.0).all()
    assert np.abs(np.diff(kept)).max() < 0.011  # no step
    assert (kept[400:] == 0.0).all()


def test_gain_is_of_what_lies_above_the_threshold():
    radiance = radiances()
    base = highlight_base(radiance, np.ones(len(radiance)), 1.0)
    clipped = base + highlight_light(radiance, 1.0, 0.0)
    np.testing.assert_allclose(clipped.max(axis=1), np.minimum(radiance.max(axis=1), 1.0))
    twice = base + highlight_light(radiance, 1.0, 2.0)
    np.testing.assert_allclose(twice - clipped, 2.0 * (radiance - clipped), atol=1e-9)


def test_share_rises_smoothly_from_least_radius():
    coc = np.linspace(-8, 8, 1601)
    share = highlight_share(coc, 3.0)
    np.testing.assert_allclose(share, share[::-1], atol=1e-12)
    assert (share[np.abs(coc) <= 3.0] == 0.0).all()
    assert (share[np.abs(coc) >= 4.5] == 1.0).all()
    assert (np.diff(share[800:]) >= 0.0).all()


def test_more_samples_leave_larger_discs_to_the_samples():
    assert least_coc(1) == least_coc(50) == 1.0
    # 16 samples a pixel: 16 pi C^2 = n.
    assert 16 * np.pi * least_coc(4096) ** 2 == pytest.approx(4096)


def test_amplification_leaves_darkness_and_multiplies_white():
    even = np.ones(3) / 3
    grey = amplify(np.array([0.5, 0.5, 0.5]), 100.0, even)
    assert grey == pytest.approx(0.5 * (1 + 100 * 0.5**10))
    assert amplify(np.ones(3), 100.0, even) == pytest.approx(101.0)
    assert (amplify(np.array([0.2, 0.7, 0.1]), 0.0, even) == [0.2, 0.7, 0.1]).all()
    assert amplify(np.array([0.0, 1.0, 0.0]), 9.0, (0.2, 0.5, 0.3))[1] == 1 + 9 * 0.5**10


def test_amplification_multiplies_what_is_brighter_than_white_as_white():
    sun = amplify(np.full(3, 5e4, np.float32), np.float32(1e4), (0.3, 0.4, 0.3))
    assert np.isfinite(sun).all()
    assert sun == pytest.approx(5e4 * (1 + 1e4))
