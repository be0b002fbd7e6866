"""Wavelengths of lens samples and their weights in the colour channels."""

import numpy as np
import pytest

from addon.lens_io.glasses.dispersion import glass_dispersion
from addon.sampling.chromatic import ChromaticAberration
from addon.sampling.equalizer import EQUALIZER_PRESETS, FLAT, SpectralEqualizer, band
from addon.sampling.halton import halton
from addon.sampling.iris import concentric_disk
from addon.sampling.spectral_samples import (
    SpectralSamples,
    channel_density,
    normalized,
    wavelengths_for,
)
from addon.sampling.spectrum import color_matching, primaries_of, xyz_to_rgb

SPACES = ("ITU-R BT.709", "ITU-R BT.2020", "ACEScg")


def aberration(mode="SPECTRAL", equalizer=FLAT, **others):
    return ChromaticAberration(
        mode, 1.0, 0.05, glass_dispersion(), 0.05, equalizer=equalizer, **others
    )


EVERY = [
    aberration("RGB"),
    *(aberration(primaries=space) for space in SPACES),
    *(aberration(equalizer=curve) for _, curve in EQUALIZER_PRESETS.values()),
    aberration(equalizer=band(560.0, 40.0)),
    aberration(wavelength_range=(600.0, 650.0)),
    aberration(wavelength_range=(600.0, 650.0), equalizer=band(450.0, 20.0)),
]


@pytest.mark.parametrize("model", EVERY)
@pytest.mark.parametrize("count", [1, 2, 16, 17, 128, 510])
def test_weights_are_positive_and_sum_to_the_number_of_samples(model, count):
    for seed in (0, 7):
        samples = wavelengths_for(model, count, seed)
        assert samples.weights.shape == (count, 3)
        assert np.all(samples.weights > 0.0)
        np.testing.assert_allclose(samples.weights.sum(axis=0), count, rtol=1e-12)
        low, high = model.wavelength_range if model.mode == "SPECTRAL" else (475.0, 650.0)
        assert np.all((samples.wavelengths_nm >= low) & (samples.wavelengths_nm <= high))


@pytest.mark.parametrize("model", EVERY)
def test_white_stays_white_after_any_number_of_samples_in_32_bits(model):
    # As the engine sums: in floats of 32 bits, each channel divided by its weights so far.
    weights = wavelengths_for(model, 256).weights.astype(np.float32)
    wall = np.array([0.18, 0.18, 0.18], np.float32)
    added = np.cumsum(weights * wall, axis=0, dtype=np.float32)
    shown = added / np.cumsum(weights, axis=0, dtype=np.float32)
    # Three orders below the bar of 0.1 %: the rounding of 256 sums.
    np.testing.assert_allclose(shown, np.broadcast_to(wall, shown.shape), rtol=2e-5)


def test_a_smaller_count_is_the_beginning_of_a_larger():
    for model in (aberration(), aberration("RGB")):
        few, many = wavelengths_for(model, 50), wavelengths_for(model, 128)
        np.testing.assert_array_equal(few.wavelengths_nm, many.wavelengths_nm[:50])
        np.testing.assert_array_equal(few.lens_indices, many.lens_indices[:50])
        ratio = few.weights / many.weights[:50]
        np.testing.assert_allclose(ratio, np.broadcast_to(ratio[0], ratio.shape), rtol=1e-12)


def test_three_samples_share_a_place_and_no_channel_is_left_out():
    for model in (aberration(), aberration("RGB")):
        samples = wavelengths_for(model, 99)
        np.testing.assert_array_equal(samples.lens_indices, np.arange(99) // 3)
        groups = samples.weights.reshape(33, 3, 3).sum(axis=1)
        # Each place on the lens gives each channel a fair part of its light: 3 on average, more
        # where two of its wavelengths are near the channel's edges.
        assert groups.min() > 2.0 and groups.max() < 5.5


def test_rgb_mode_draws_each_channel_at_its_own_wavelength():
    samples = wavelengths_for(aberration("RGB"), 30)
    for channel, nm in enumerate((650.0, 510.0, 475.0)):
        own = samples.wavelengths_nm == nm
        assert own.sum() == 10
        # What others add to a channel is far below what 16 bits show.
        assert samples.weights[~own, channel].sum() < 1e-4 * 30


def test_thirty_three_samples_are_spread_evenly():
    density = channel_density((380.0, 780.0), FLAT, "ITU-R BT.709")
    cumulative = np.concatenate([[0.0], np.cumsum(density.density)])
    for seed in (0, 3):
        wavelengths = wavelengths_for(aberration(), 99, seed).wavelengths_nm
        places = np.interp(wavelengths, density.edges_nm, cumulative)
        for start in (0, 33, 66):
            gaps = np.diff(np.sort(places[start : start + 33]))
            np.testing.assert_allclose(gaps, 1.0 / 33.0, rtol=1e-6)


@pytest.mark.parametrize("space", SPACES)
def test_colors_converge_to_the_observer_in_the_working_space(space):
    # The mean wavelength of a channel is that of the colour-matching functions, clipped at zero.
    samples = wavelengths_for(aberration(primaries=space), 4096)
    mean = (samples.weights * samples.wavelengths_nm[:, None]).mean(axis=0)
    places = np.linspace(380.0, 780.0, 4001)
    light = np.maximum(color_matching(places) @ xyz_to_rgb(space).T, 0.0)
    exact = (light * places[:, None]).sum(axis=0) / light.sum(axis=0)
    np.testing.assert_allclose(mean, exact, atol=0.1)


def test_equalizer_multiplies_the_light():
    curve = SpectralEqualizer((420.0, 560.0, 640.0), (0.2, 1.0, 0.5))
    samples = wavelengths_for(aberration(equalizer=curve), 4096)
    mean = (samples.weights * samples.wavelengths_nm[:, None]).mean(axis=0)
    places = np.linspace(380.0, 780.0, 4001)
    light = np.maximum(color_matching(places) @ xyz_to_rgb("ITU-R BT.709").T, 0.0)
    light *= curve(places)[:, None]
    exact = (light * places[:, None]).sum(axis=0) / light.sum(axis=0)
    np.testing.assert_allclose(mean, exact, atol=0.1)


def test_a_channel_without_light_in_the_band_takes_the_band_evenly():
    samples = wavelengths_for(aberration(equalizer=band(640.0, 40.0)), 999)
    blue = samples.weights[:, 2]
    assert (blue * samples.wavelengths_nm).mean() == pytest.approx(640.0, abs=1.0)


def test_weak_ranges_cost_nothing():
    wavelengths = wavelengths_for(aberration(equalizer=band(560.0, 40.0)), 128).wavelengths_nm
    assert np.all(np.abs(wavelengths - 560.0) <= 21.1)


def test_gaps_in_the_equalizer_are_never_drawn():
    gap = SpectralEqualizer((450.0, 451.0, 500.0, 501.0, 550.0, 551.0), (0, 1, 1, 0, 0, 1))
    density = channel_density((380.0, 780.0), gap, "ITU-R BT.709")
    cumulative = np.concatenate([[0.0], np.cumsum(density.density)])
    # The very borders of the gaps among them.
    uniform = np.unique(np.concatenate([cumulative[cumulative < 1.0], np.linspace(0, 1, 99)[:-1]]))
    wavelengths, weights = density.draw(uniform)
    assert np.all(np.isfinite(weights)) and np.all(weights > 0.0)
    assert np.all(np.diff(wavelengths) > 0.0)
    assert not np.any((wavelengths > 501.2) & (wavelengths < 549.8))
    assert wavelengths[0] > 449.8


def test_seeds_rotate():
    plain, other = (wavelengths_for(aberration(), 16, seed).wavelengths_nm for seed in (0, 1))
    assert np.abs(plain - other).min() > 0.0


def test_working_spaces_of_blender():
    assert primaries_of("Linear Rec.709") == SPACES[0]
    assert primaries_of("Linear Rec.2020") == SPACES[1]
    assert primaries_of("ACEScg") == SPACES[2]
    assert primaries_of("Filmic Log") is None


# A picture of few words: edges and thin lines in all directions, blurred over the lens and shifted
# over the wavelength, looked at from places across them.
DIRECTIONS = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False) + 0.1
PLACES = np.linspace(-1.3, 1.3, 21)


def picture(lens, wavelengths, blur, axial, lateral):
    """Values of shape (places, directions, samples)."""
    unit = (780.0 - wavelengths) / 400.0
    along = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], axis=1) @ lens.T
    moved = (blur + axial * unit) * along + lateral * unit * np.cos(DIRECTIONS)[:, None]
    across = PLACES[:, None, None] + moved
    return np.concatenate([across > 0.0, np.abs(across) < 0.15]).astype(float)


def rendered(samples, seed, settings):
    shift = 0.5 if seed == 0 else np.random.default_rng(seed).random(2)
    lens = concentric_disk(halton(0, samples.lens_indices.max() + 1, (2, 7), shift))
    values = picture(lens[samples.lens_indices], samples.wavelengths_nm, *settings)
    return values @ samples.weights / samples.weights.sum(axis=0)


def squared_error(model, count, settings, importance=True):
    truth = rendered(wavelengths_for(model, 12000), 0, settings)
    errors = [
        rendered(wavelengths_for(model, count, seed, importance), seed, settings) - truth
        for seed in range(12)
    ]
    return np.square(errors)


@pytest.mark.parametrize("count", [32, 64, 128])
@pytest.mark.parametrize("center", [460.0, 540.0, 610.0])
def test_importance_sampling_of_a_40_nm_band_has_a_third_of_the_variance(center, count):
    model = aberration(equalizer=band(center, 40.0))
    settings = (0.4, 0.6, 0.8)
    by_importance = squared_error(model, count, settings).mean(axis=(0, 1, 2))
    by_weight = squared_error(model, count, settings, importance=False).mean(axis=(0, 1, 2))
    assert by_weight.mean() >= 3.0 * by_importance.mean()
    assert np.all(by_weight >= 3.0 * by_importance)


def test_each_channel_has_its_part_of_the_samples():
    # Samples that a channel is worth: 1 over the mean square of its weights.
    worth, even = (
        1.0 / np.square(wavelengths_for(aberration(), 4095, importance=way).weights).mean(axis=0)
        for way in (True, False)
    )
    assert worth.min() > 0.37
    assert worth.min() > 1.9 * even.min()


@pytest.mark.parametrize("mode", ["SPECTRAL", "RGB"])
def test_shared_places_take_the_colour_noise_out_of_neutral_blur(mode):
    # Against a place of its own for each sample.
    settings = (1.0, 0.0, 0.0)
    model, count = aberration(mode), 126
    shared = wavelengths_for(model, count)
    apart = SpectralSamples(shared.wavelengths_nm, shared.weights, np.arange(count))
    truth = rendered(wavelengths_for(model, 12000), 0, settings)
    noise = []
    for samples in (shared, apart):
        error = np.array([rendered(samples, seed, settings) - truth for seed in range(12)])
        chroma = error - error.mean(axis=-1, keepdims=True)
        noise.append((np.square(chroma).mean() ** 0.5, np.square(error).mean() ** 0.5))
    (shared_chroma, shared_error), (apart_chroma, apart_error) = noise
    assert shared_chroma < 0.45 * apart_chroma
    assert shared_error < 1.1 * apart_error


def local_maxima(values, least):
    """Count the maxima of a curve that stand out by `least` on both sides."""
    count, rising, top, bottom = 0, True, values[0], values[0]
    for value in values:
        top, bottom = max(top, value), min(bottom, value)
        if rising and top - value > least:
            count, rising, bottom = count + 1, False, value
        elif not rising and value - bottom > least:
            rising, top = True, value
    return count


@pytest.mark.parametrize("preset", ["FLAT", "ENDS", "THREE_BANDS", "COMB"])
@pytest.mark.parametrize("length_px", [10.0, 20.0, 30.0])
def test_fringes_show_no_bands(preset, length_px):
    # A line of 3 pixels under a lateral aberration of many, hardly blurred.
    model = aberration(equalizer=EQUALIZER_PRESETS[preset][1])
    places = np.arange(-12.0, length_px + 12.0)[:, None]

    def profile(count):
        samples = wavelengths_for(model, count)
        lens = concentric_disk(halton(0, count // 3 + 1, (2, 7), 0.5))[samples.lens_indices]
        moved = places - (780.0 - samples.wavelengths_nm) / 400.0 * length_px - 0.6 * lens[:, 0]
        covered = np.clip(moved + 2.0, 0, 1) - np.clip(moved - 1.0, 0, 1)
        return covered @ samples.weights / count

    few, many = profile(128), profile(4096)
    for channel in range(3):
        assert local_maxima(few[:, channel], 0.004) == local_maxima(many[:, channel], 0.004)
    # The red of the observer has a second lobe in the violet.
    assert local_maxima(many[:, 0], 0.004) >= 1


def test_normalized_keeps_ratios_inside_a_channel():
    weights = np.array([[1.0, 2.0, 4.0], [3.0, 2.0, 1.0]])
    found = normalized(weights)
    np.testing.assert_allclose(found.sum(axis=0), 2.0)
    np.testing.assert_allclose(found[0] / found[1], weights[0] / weights[1])
