"""The places on the lens that samples stand for: all of them, evenly, in whole intervals."""

import numpy as np
import pytest

from addon.sampling.iris import Iris
from addon.sampling.sequence import lens_samples
from addon.sampling.subsamples import intervals, subsample_offsets

SAMPLES, EACH = 32, 4


def split(progressive, iris=None):
    points = lens_samples(0, SAMPLES * (1 + EACH), iris or Iris())
    drawn, further = points[:SAMPLES], points[SAMPLES:]
    return drawn, further, *subsample_offsets(drawn, further, progressive)


@pytest.mark.parametrize("progressive", [False, True])
def test_every_place_belongs_to_one_sample(progressive):
    drawn, further, offsets, counts = split(progressive)
    assert counts.sum() == len(further)
    places = np.concatenate([drawn[i] + offsets[i, : counts[i]] for i in range(SAMPLES)])
    order, expected = np.lexsort(places.T), np.lexsort(further.T)
    assert np.allclose(places[order], further[expected], atol=1e-15)


def test_a_place_belongs_to_the_nearest_sample():
    drawn, _, offsets, counts = split(progressive=False)
    for i in range(SAMPLES):
        for offset in offsets[i, : counts[i]]:
            distance = np.linalg.norm(drawn - (drawn[i] + offset), axis=1)
            assert distance.argmin() == i


def test_places_lie_inside_the_iris_whatever_its_shape():
    drawn, _, offsets, counts = split(False, Iris(blades=3, ratio=2.0))
    places = np.concatenate([drawn[i] + offsets[i, : counts[i]] for i in range(SAMPLES)])
    assert np.abs(places).max() <= 1.0


def test_intervals_double_and_end_with_all_samples():
    assert intervals(32, True) == [(0, 8), (8, 16), (16, 32)]
    assert intervals(32, False) == [(0, 32)]
    assert intervals(5, True) == [(0, 5)]
    assert intervals(1, True) == [(0, 1)]


@pytest.mark.parametrize("end", [8, 16, 32])
def test_a_progressive_picture_covers_the_lens_evenly_after_each_interval(end):
    drawn, _, offsets, counts = split(progressive=True)
    places = np.concatenate(
        [np.vstack([drawn[i], drawn[i] + offsets[i, : counts[i]]]) for i in range(end)]
    )
    # No place on the disk is farther from one than twice the radius of its share of the area.
    u = np.linspace(-1, 1, 41)
    grid = np.stack(np.meshgrid(u, u), axis=-1).reshape(-1, 2)
    grid = grid[np.linalg.norm(grid, axis=1) < 0.95]
    gap = np.linalg.norm(grid[:, None] - places[None], axis=2).min(axis=1).max()
    assert gap < 2.2 / np.sqrt(len(places))


def test_no_further_places_leave_every_sample_alone():
    points = lens_samples(0, 8, Iris())
    offsets, counts = subsample_offsets(points, np.empty((0, 2)))
    assert offsets.shape == (8, 0, 2)
    assert not counts.any()
