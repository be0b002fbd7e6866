import numpy as np
import pytest

from addon.sampling.iris import Iris
from addon.sampling.pixel_filter import (
    blackman_harris,
    filter_density,
    filter_offsets,
    movement_size,
    subpixel_centers,
    subpixel_weights,
)
from addon.sampling.sequence import LATTICE_PLACES, lattice_sets, lens_samples, pixel_offsets


def test_the_first_sample_is_the_pinhole_at_the_pixel_s_centre():
    assert np.array_equal(lens_samples(0, 1, Iris()), [[0.0, 0.0]])
    assert np.allclose(pixel_offsets(0, 1, "BLACKMAN_HARRIS", 1.5), 0.0, atol=1e-3)


def test_a_continued_sequence_is_the_same_as_one_drawn_at_once():
    iris = Iris(5, 0.2, 1.3)
    parts = [lens_samples(0, 10, iris, 3), lens_samples(10, 22, iris, 3)]
    assert np.array_equal(np.concatenate(parts), lens_samples(0, 32, iris, 3))


def test_seeds_give_different_sequences_and_the_same_seed_the_same():
    assert np.array_equal(lens_samples(0, 8, Iris(), 7), lens_samples(0, 8, Iris(), 7))
    assert not np.array_equal(lens_samples(0, 8, Iris(), 7), lens_samples(0, 8, Iris(), 8))


def test_lens_and_pixel_positions_are_not_correlated():
    lens = lens_samples(0, 2048, Iris())
    pixel = pixel_offsets(0, 2048, "BOX", 1.0)
    correlation = np.corrcoef(np.concatenate([lens, pixel], axis=1).T)
    # 1/sqrt(2048) = 0.022 for independent noise.
    assert np.abs(correlation - np.eye(4)).max() < 0.03


def test_a_box_spreads_over_exactly_its_size():
    offsets = filter_offsets(np.random.default_rng(1).random((10000, 2)), "BOX", 2.0)
    assert offsets.min() >= -1.0 and offsets.max() <= 1.0
    assert offsets.std() == pytest.approx(2.0 / np.sqrt(12), rel=0.01)


def test_blackman_harris_offsets_have_the_window_s_variance():
    x = np.linspace(-0.5, 0.5, 20001)
    window = blackman_harris(x)
    variance = (window * x**2).sum() / window.sum()
    uniform = (np.arange(20000) + 0.5) / 20000
    offsets = filter_offsets(np.stack([uniform, uniform], axis=-1), "BLACKMAN_HARRIS", 1.5)
    # The support is twice the size.
    assert offsets.var() == pytest.approx(variance * 3.0**2, rel=1e-3)


@pytest.mark.parametrize("kind, size", [("BOX", 1.0), ("BOX", 2.3), ("BLACKMAN_HARRIS", 1.5)])
@pytest.mark.parametrize("subpixels", [1, 2, 4])
def test_weighted_subpixels_make_the_same_filter_as_single_samples(kind, size, subpixels):
    """Moments of the weighted places against the filter's own, by numerical integration."""
    uniform = (np.arange(40000) + 0.5) / 40000
    moved = filter_offsets(uniform, kind, movement_size(kind, size, subpixels))
    weights = subpixel_weights(moved, kind, size, subpixels)
    places = moved[:, None] + subpixel_centers(subpixels)
    x = np.linspace(-size, size, 40001)
    density = filter_density(x, kind, size)
    for moment in (0, 2, 4):
        mean = (weights * places**moment).sum() / len(uniform)
        expected = (density * x**moment).sum() * (x[1] - x[0])
        # The movement's table has 2048 steps over the filter's support.
        assert mean == pytest.approx(expected, rel=3e-3)


def test_a_box_of_one_pixel_needs_no_weights():
    moved = pixel_offsets(0, 512, "BOX", 1.0, subpixels=4)[:, 0]
    assert np.array_equal(subpixel_weights(moved, "BOX", 1.0, 4), np.full((512, 4), 0.25))


def test_lattice_sets_are_even_each_and_more_so_together():
    sets = lattice_sets(Iris())
    assert sets.shape == (16, LATTICE_PLACES, 2)

    def unevenness(places):
        """Standard deviation of the numbers in eight sectors of half the area each way, of mean."""
        turn = np.floor(np.mod(np.arctan2(places[:, 1], places[:, 0]) / (np.pi / 2), 4.0))
        outer = np.hypot(*places.T) > np.sqrt(0.5)
        counts = np.bincount((2 * turn + outer).astype(int), minlength=8)
        return counts.std() / counts.mean()

    each = np.mean([unevenness(places) for places in sets])
    # Of places at random it would be 0.78 and 0.19.
    assert each < 0.5
    assert unevenness(sets.reshape(-1, 2)) < 0.08
    # No two are the same.
    gaps = np.linalg.norm(sets.reshape(-1, 1, 2) - sets.reshape(1, -1, 2), axis=-1)
    assert gaps[gaps > 0].min() > 0.03 and (gaps == 0).sum() == gaps.shape[0]
