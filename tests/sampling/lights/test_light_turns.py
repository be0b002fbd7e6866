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
    """About as much, so that the ratio of light is hardly biased; all together are even."""
    normals = sphere_points(np.random.default_rng(1).random((300, 2)))
    towards = np.stack(
        [directions(sky_places(4, 32, seed=2, stream=stream)) for stream in range(2)], axis=1
    )
    light = np.maximum(towards.reshape(32, 8, 3) @ normals.T, 0.0)
    np.testing.assert_allclose(light.mean(axis=(0, 1)), 0.25, rtol=0.02)
    assert (light.mean(axis=1) > 0.0).all()
    assert (light.mean(axis=1).std(axis=0) / 0.25).mean() < 0.2


def directions(u):
    return sphere_points(np.stack([1.0 - u[..., 1], u[..., 0]], axis=-1).reshape(-1, 2)).reshape(
        *u.shape[:2], 3
    )


def test_directions_of_a_sky_stand_for_its_light():
    pixels = np.full((32, 64, 3), 0.3)
    pixels[24:26, 40:42] = 60.0
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
            u = sky_places(4, 128, stream=follows).reshape(-1, 2)
            found, light = sky.directions(u, follows)
            mean += 0.5 * (np.maximum(found @ normal, 0.0) * light[:, 0]).mean()
        assert mean == pytest.approx(expected, rel=0.04)
