"""Turns of lights, and places on them."""

import numpy as np
import pytest

from addon.sampling.lights.light_samples import (
    ball_points,
    disk_points,
    schedule,
    sequence,
    sphere_points,
    turns_of,
)


def test_turns_are_in_proportion_and_none_is_left_out():
    assert turns_of([3.0, 1.0], 64).tolist() == [48, 16]
    turns = turns_of([1.0, 1e-6, 0.0, 0.5], 32)
    assert turns.sum() == 32
    assert turns[1] == 1 and turns[2] == 0 and turns[0] > turns[3] > 8


def test_with_more_lights_than_samples_the_strongest_have_their_turns():
    turns = turns_of(np.arange(10.0), 4)
    assert turns.tolist() == [0] * 6 + [1] * 4
    assert turns_of([0.0, 0.0], 4).tolist() == [0, 0]


def test_no_light_is_overdrawn_before_its_share_has_passed():
    """What a light's samples stand for is at most what has been seen, after any number."""
    turns = turns_of([0.6, 0.2, 0.1, 0.04, 0.03, 0.03], 64)
    lights, numbers = schedule(turns)
    assert np.array_equal(np.bincount(lights), turns)
    for light, count in enumerate(turns):
        mine = np.flatnonzero(lights == light)
        assert numbers[mine].tolist() == list(range(count))
        taken = np.arange(1, count + 1) * 64 / count
        # Two light samples of slack: lights whose turns are due together follow one another.
        if count < 8:
            assert (taken <= mine + 1 + 3).all()


def test_turns_do_not_follow_the_lens():
    """Two lights in turns would each be seen from one half of the lens: its first base is 2."""
    lights, _ = schedule(turns_of([1.0, 1.0], 64))
    first_halves = np.arange(64) % 2 == 0
    assert 20 < ((lights == 0) == first_halves).sum() < 44


@pytest.mark.parametrize("direction", [(0, 0, 1), (0.6, 0, 0.8), (0.5, -0.5, 0.7071)])
def test_a_ball_looks_like_an_even_disk_from_everywhere(direction):
    points = ball_points(sequence(np.arange(20000), 3))
    along = np.array(direction) / np.linalg.norm(direction)
    radius2 = np.square(points).sum(axis=1) - np.square(points @ along)
    # Of an even disk the square of the radius is even.
    for share in (0.1, 0.3, 0.5, 0.8):
        assert (radius2 < share).mean() == pytest.approx(share, abs=0.01)


def test_disk_and_sphere_are_even():
    u = sequence(np.arange(8192), 2)
    disk = disk_points(u)
    assert (np.square(disk).sum(axis=1) < 0.25).mean() == pytest.approx(0.25, abs=0.01)
    assert (disk[:, 0] > 0.0).mean() == pytest.approx(0.5, abs=0.01)
    sphere = sphere_points(u)
    np.testing.assert_allclose(np.linalg.norm(sphere, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(sphere.mean(axis=0), 0.0, atol=0.01)
