"""Which places on lights each lens sample is lit from."""

import numpy as np
import pytest

from addon.sampling.lights.light_samples import sky_places, sphere_points
from addon.sampling.lights.light_turns import GENERATION, MOST_LISTED, LightTurns
from addon.sampling.lights.sky_samples import Sky


def turns_of_lights(lamps, sky, samples=None, angles=None):
    shares = np.append(np.asarray(lamps, float), sky)
    angles = np.zeros(len(shares)) if angles is None else np.append(angles, 0.0)
    return LightTurns(shares, angles, np.zeros(len(shares), bool), samples)


def test_every_lens_sample_sees_all_main_lights():
    turns = turns_of_lights([0.5, 0.2, 0.0], 0.3, angles=[0.3, 0.0, 0.3])
    assert turns.counts.tolist() == [64, 8, 0, 256]
    for sample in range(100):
        found = turns.of_samples([sample])
        assert found.counts.tolist() == [1, 1, 0, 8]
        assert (found.weights == 1.0).all()
    lights, numbers = turns.lights_and_numbers()
    found = turns.of_samples([5])
    assert lights[found.places].tolist() == [0, 1] + [3] * 8
    assert numbers[found.places].tolist() == [5, 5, *range(40, 48)]


def test_half_of_a_picture_has_other_places_than_the_other_half():
    """A noise threshold compares halves: what they share it would not see as noise."""
    turns = turns_of_lights([0.5], 0.5, angles=[0.3])
    halves = [
        {place for n in half for place in turns.of_samples([n]).places.tolist()}
        for half in (range(8, 16), range(16, 32))
    ]
    assert halves[0].isdisjoint(halves[1])


def test_groups_of_sky_meet_others_when_they_come_again():
    turns = turns_of_lights([0.5], 0.5)
    numbers = [turns.lights_and_numbers()[1][turns.of_samples([n]).places[1:]] for n in range(64)]
    pairs = {tuple(own // 8) for own in np.sort(np.reshape(numbers, (64, 2, 4))[:, :, 0])}
    assert len(pairs) == 64
    # Each of two groups, and each direction of all as often.
    assert (np.bincount(np.ravel(numbers)) == 2).all()
    assert all(set(own % 8) == set(range(8)) for own in numbers)


def test_weak_lights_shine_as_much_as_all_their_turns():
    turns = turns_of_lights([0.7] + [0.01] * 20 + [0.002] * 50, 0.0)
    weights = np.mean([turns.of_samples([n]).weights for n in range(GENERATION)], axis=0)
    np.testing.assert_allclose(weights, 1.0, atol=1e-12)
    together = turns.of_samples(range(8))
    assert len(together.places) <= MOST_LISTED
    # Steady light has all of them.
    assert (turns.steady().weights == 1.0).all()
    assert turns.steady().counts[1:].sum() == 0


@pytest.mark.parametrize("lamps", [1, 6, 40])
def test_lists_have_room(lamps):
    turns = turns_of_lights(np.full(lamps, 0.5 / lamps), 0.5, angles=np.full(lamps, 0.5))
    assert len(turns.of_samples(range(1000)).places) <= MOST_LISTED
    assert len(turns.steady().places) <= MOST_LISTED


def test_few_samples_need_few_places():
    turns = turns_of_lights([0.5], 0.5, samples=3, angles=[1.0])
    assert turns.counts.tolist() == [3, 24]


def test_every_lens_sample_has_sky_above_every_surface():
    """One of each pair, so that none asks nothing of the sky; all together are even."""
    normals = sphere_points(np.random.default_rng(1).random((300, 2)))
    towards = np.stack(
        [directions(sky_places(2, 32, seed=2, stream=stream)) for stream in range(2)], axis=1
    )
    light = np.maximum(towards.reshape(32, 8, 3) @ normals.T, 0.0)
    np.testing.assert_allclose(light.mean(axis=(0, 1)), 0.25, rtol=0.02)
    assert ((light > 0.0).sum(axis=1) == 4).all()


def directions(u):
    return sphere_points(np.stack([1.0 - u[..., 1], u[..., 0]], axis=-1).reshape(-1, 2)).reshape(
        *u.shape[:-1], 3
    )


def sky_with_a_sun():
    pixels = np.full((32, 64, 3), 0.3)
    pixels[24:26, 40:42] = 60.0
    return pixels


def test_what_is_hidden_of_one_group_says_nothing_of_the_light_of_the_other():
    """The shader's share of the sky, by a twin, where much of it is hidden: right in the mean.

    What is hidden of all directions together follows the sun: up to 0.03 too dark here.
    """
    sky = Sky(sky_with_a_sun(), np.eye(3))
    errors = {"groups": [], "together": []}
    z = (np.arange(400) + 0.5) / 200 - 1.0
    around = (0.5 - (np.arange(800) + 0.5) / 800) * 2.0 * np.pi
    across = np.sqrt(1.0 - z * z)[:, None]
    all_around = np.stack(
        np.broadcast_arrays(across * np.cos(around), across * np.sin(around), z[:, None]), axis=-1
    )
    rows = ((np.arcsin(z) / np.pi + 0.5) * 32).astype(int)
    light_around = sky.pixels[rows][:, np.arange(800) * 64 // 800, 0] * (4.0 * np.pi / 320000)
    found = []
    for seed in range(40):
        towards, light = np.empty((2, 32, 2, 4, 3))
        for follows in (False, True):
            u = sky_places(2, 32, seed=seed, stream=follows).reshape(-1, 2)
            for given, part in zip((towards, light), sky.directions(u, follows), strict=True):
                given[:, :, follows::2] = part.reshape(32, 2, 2, 3)
        found.append((towards, light[..., 0]))
    towards, light = (np.concatenate(part) for part in zip(*found, strict=True))
    for normal in np.array([(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)]):
        for wall, opposite in ((0.2, 0.2), (0.5, 0.8), (0.8, 0.3)):

            def is_open(d, wall=wall, opposite=opposite):
                return (d[..., 0] > -wall) & (d[..., 1] < opposite) & (d[..., 2] > 0.0)

            given = np.maximum(all_around @ normal, 0.0) * light_around
            whole, exact = given.sum(), given[is_open(all_around)].sum()
            cosine = np.maximum(towards @ normal, 0.0)
            seen = is_open(towards)
            given = cosine * light / 8.0
            arriving = (given * seen).sum(axis=(1, 2))
            parts = (cosine * seen).sum(axis=2) / cosine.sum(axis=2)
            lacks = 0.5 * whole - given.sum(axis=2)
            shares = arriving + (parts[:, ::-1] * lacks).sum(axis=1)
            errors["groups"].append(np.maximum(shares, 0.0).mean() / exact - 1.0)
            part = (cosine * seen).sum(axis=(1, 2)) / cosine.sum(axis=(1, 2))
            shares = arriving + part * lacks.sum(axis=1)
            errors["together"].append(np.maximum(shares, 0.0).mean() / exact - 1.0)
    # 1280 sets that differ by about 0.3: chance is 0.008 at one place.
    assert np.abs(errors["groups"]).max() < 0.015
    assert abs(np.mean(errors["groups"])) < 0.006
    assert np.min(errors["together"]) < -0.03


def test_directions_of_a_sky_stand_for_its_light():
    pixels = sky_with_a_sun()
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    sky = Sky(pixels, turn)
    z = np.sin(((np.arange(32) + 0.5) / 32 - 0.5) * np.pi)
    around = (0.5 - (np.arange(64) + 0.5) / 64) * 2.0 * np.pi
    across = np.sqrt(1.0 - z * z)[:, None]
    towards = np.stack(
        np.broadcast_arrays(across * np.cos(around), across * np.sin(around), z[:, None]), axis=-1
    )
    solid = np.diff(np.sin((np.arange(33) / 32 - 0.5) * np.pi)) * 2.0 * np.pi / 64
    for normal in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)):
        cosine = np.maximum(towards @ turn @ np.array(normal), 0.0)
        expected = (cosine * pixels[..., 0] * solid[:, None]).sum()
        mean = 0.0
        for follows in (False, True):
            u = sky_places(2, 128, stream=follows).reshape(-1, 2)
            found, light = sky.directions(u, follows)
            mean += 0.5 * (np.maximum(found @ normal, 0.0) * light[:, 0]).mean()
        assert mean == pytest.approx(expected, rel=0.04)
