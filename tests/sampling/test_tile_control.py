"""Tiles stop when they are good enough, the picture when its mean error is the number."""

import numpy as np
import pytest

from addon.sampling.rounds import looks
from addon.sampling.tile_control import TileControl, grown, runs, smoothed

WIDTH, HEIGHT = 160, 96


def play(errors_at_16, target, power=1.25, least=16, most=4096):
    """Carry out a picture whose tiles' errors fall by a power; return the control and counts."""
    control = TileControl(target, WIDTH, HEIGHT, least, most)
    counts = np.zeros(control.shape, int)
    marks = looks(most)
    for number, look in enumerate(marks):
        if look < 16:
            continue
        counts[control.active] = look
        true = errors_at_16 * (16.0 / counts.clip(min=16)) ** power
        # The difference of two pictures whose errors are independent beside their common part.
        control.observe(look, look // 2, true * ((2.0**power) - 1.0))
        following = marks[min(number + 1, len(marks) - 1)]
        control.decide(look, true, following)
        if control.done:
            break
    return control, counts


def uneven():
    errors = np.full((6, 10), 0.002)
    errors[1:4, 2:5] = 0.2
    return errors


@pytest.mark.parametrize("target", [0.02, 0.01, 0.005])
def test_the_mean_error_comes_to_the_number(target):
    control, _ = play(uneven(), target)
    assert 0.5 * target < control.error <= target


def test_samples_go_where_the_error_is():
    _, counts = play(uneven(), 0.005)
    assert counts[2, 3] > 4 * counts[5, 9]
    assert counts[5, 9] == 16


def test_neighbours_of_a_tile_go_on_with_it():
    control, counts = play(uneven(), 0.005)
    # A step between neighbours is never one from an active tile that is above the number.
    above = counts == counts.max()
    assert grown(counts > 16)[above].all()
    assert (counts[0, 2:5] > 16).all()


def test_a_picture_that_is_good_enough_stops_at_the_first_look():
    control, counts = play(np.full((6, 10), 0.001), 0.01)
    assert (counts == 16).all()
    assert control.done


def test_a_plain_picture_is_as_good_where_it_is_not_plain_as_a_full_one():
    errors = np.full((6, 10), 1e-5)
    errors[2:4, 2:5] = np.array([[0.1, 0.02, 0.04], [0.02, 0.6, 0.05]])
    control, counts = play(errors, 0.05)
    assert errors.mean() < 0.5 * 0.05 and not (counts == 16).all()
    judged = smoothed(errors) > 0.05
    mean = control.errors[judged].mean()
    assert 0.4 * 0.05 < mean <= 0.05
    # The worst tile of a full picture is above the number, too.
    assert control.errors.max() > 0.05
    assert (counts[:, 7:] == 16).all()


def test_the_least_and_the_most_samples_are_bounds():
    _, counts = play(np.full((6, 10), 0.001), 0.01, least=64)
    assert (counts == 64).all()
    control, counts = play(np.full((6, 10), 10.0), 0.01, most=100)
    assert counts.max() == 100
    assert control.done
    assert control.left == 60


@pytest.mark.parametrize("power", [1.0, 1.25, 1.5])
def test_the_power_is_found_in_the_history(power):
    control, _ = play(np.full((6, 10), 1.0), 1e-4, power=power)
    usual = TileControl(0.01, WIDTH, HEIGHT, 16, 4096).power
    # Eight doublings beside as much weight of what is usual.
    assert abs(control.power - power) <= 0.6 * abs(usual - power) + 1e-9


def test_the_rest_is_that_of_a_power_law():
    control = TileControl(0.01, WIDTH, HEIGHT, 16, 4096)
    power = control.power
    # e(n) = n^-p, D = e(m) - e(n).
    rest = control.rest(48, 32)
    assert rest == pytest.approx(48.0**-power / (32.0**-power - 48.0**-power))


def test_tiles_of_the_edge_count_by_their_pixels():
    control = TileControl(0.01, 24, 16, 16, 64)
    assert control.shape == (1, 2)
    control.decide(16, np.array([[0.0, 0.3]]), 24)
    # Smoothed: a quarter of the neighbour each way; the second tile is half as wide.
    assert control.error == pytest.approx((0.075 * 16 + 0.225 * 8) / 24)


def test_smoothing_keeps_what_is_even():
    assert smoothed(np.full((3, 4), 0.2)) == pytest.approx(np.full((3, 4), 0.2))


def test_runs_cover_the_chosen_tiles_once():
    chosen = np.random.default_rng(1).random((7, 9)) < 0.5
    covered = np.zeros(chosen.shape, int)
    for first, row, end, after in runs(chosen):
        assert after == row + 1
        covered[row, first:end] += 1
    assert np.array_equal(covered, chosen.astype(int))
