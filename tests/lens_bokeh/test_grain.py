import numpy as np
import pytest

from addon.errors import InputError
from addon.lens_bokeh.look.grain import Grain, transmission
from addon.lens_bokeh.openings.masks import texel_centres

DUSTY = Grain(strength=0.2, cell=0.06, dust=20, seed=5)


def over_disc(grain, size=200):
    points = texel_centres(size)
    return transmission(grain, points)[np.hypot(points[..., 0], points[..., 1]) <= 1.0]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_grain_and_dust_keep_the_energy_of_an_even_opening(seed):
    # The mean is taken on another grid of texels: grains of six texels differ by a thousandth.
    assert over_disc(Grain(0.3, 0.06, 20, seed=seed)).mean() == pytest.approx(1.0, abs=3e-3)


def test_grain_is_never_negative_however_strong():
    values = over_disc(Grain(1.0, 0.02, 100, 0.2, 1.0))
    assert np.isfinite(values).all() and values.min() >= 0.0


def test_strength_is_the_relative_deviation():
    assert over_disc(Grain(0.1, 0.03)).std() == pytest.approx(0.1, rel=0.15)
    assert np.all(over_disc(Grain()) == 1.0)


def test_same_seed_gives_the_same_speckles_at_every_place():
    points = texel_centres(64)
    assert np.array_equal(transmission(DUSTY, points), transmission(DUSTY, points))
    some = points[10:20, 30:40]
    assert np.array_equal(transmission(DUSTY, points)[10:20, 30:40], transmission(DUSTY, some))
    other = Grain(0.2, 0.06, 20, seed=6)
    assert not np.allclose(transmission(DUSTY, points), transmission(other, points), atol=0.05)


def test_dust_darkens_spots_only():
    values = over_disc(Grain(dust=8, dust_radius=0.05, dust_depth=0.9))
    clean = np.median(values)
    assert values.max() == pytest.approx(clean) and values.min() < 0.2 * clean
    assert np.mean(values < 0.99 * clean) < 8 * 0.05**2 * 1.1


@pytest.mark.parametrize("radius", [1e-3, 0.1, 1.0])
def test_each_spot_takes_its_share_wherever_points_lie(radius):
    grain = Grain(dust=60, dust_radius=radius, dust_depth=0.9, seed=3)
    elsewhere = np.random.default_rng(4).normal(size=(40, 9, 2))
    points = np.concatenate([texel_centres(40), elsewhere], axis=1)
    expected = np.ones(points.shape[:-1])
    for square, turn, size in np.random.default_rng(3).random((60, 3)):
        angle = 2.0 * np.pi * turn
        middle = np.sqrt(square) * np.array([np.cos(angle), np.sin(angle)])
        distance = np.linalg.norm(points - middle, axis=-1) / (radius * (1.0 + 2.0 * size) / 3.0)
        expected *= 1.0 - 0.9 * np.maximum(1.0 - distance**2, 0.0) ** 2
    found = transmission(grain, points)
    # All but the mean over the opening.
    np.testing.assert_allclose(found / found[0, 0] * expected[0, 0], expected, rtol=1e-12)


def test_values_out_of_range_are_refused():
    for wrong in (dict(strength=-0.1), dict(cell=0.0), dict(dust=-1), dict(dust_depth=2.0)):
        with pytest.raises(InputError, match=next(iter(wrong))):
            Grain(**wrong)
    with pytest.raises(InputError):
        Grain(strength=float("nan"))
