"""Rounds: doubling, each with places of its own, none depending on those that follow."""

import numpy as np
import pytest

from addon.sampling.iris import Iris
from addon.sampling.rounds import FURTHER_PLACES, first_look, looks
from addon.sampling.sequence import lens_samples
from addon.sampling.subsamples import subsample_offsets


@pytest.mark.parametrize("most", [16, 100, 256, 1000])
@pytest.mark.parametrize("unit", [1, 3])
def test_every_look_has_an_earlier_one_to_compare_with(most, unit):
    found = looks(most, unit)
    assert found == sorted(set(found))
    assert found[-1] == most
    for look in found[:-1]:
        if look >= first_look(unit):
            assert look // 2 in found


def test_further_places_do_not_depend_on_how_many_samples_follow():
    def places(count):
        further = lens_samples(FURTHER_PLACES, 4 * count, Iris())
        return subsample_offsets(lens_samples(0, count, Iris()), further, True)

    offsets, counts = places(32)
    longer, longer_counts = places(128)
    assert np.array_equal(longer_counts[:32], counts)
    assert np.array_equal(longer[:32, : offsets.shape[1]], offsets)


def test_the_places_of_a_round_lie_closer_the_later_it_is():
    further = lens_samples(FURTHER_PLACES, 4 * 256, Iris())
    offsets, _ = subsample_offsets(lens_samples(0, 256, Iris()), further, True)
    reach = [np.abs(offsets[a:b]).max() for a, b in ((0, 8), (16, 32), (64, 128), (128, 256))]
    assert (np.diff(reach) < 0.0).all()
