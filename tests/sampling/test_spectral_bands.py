"""Bands of wavelengths: all the light, few bands, rims where the wavelengths have them."""

import numpy as np
import pytest

from addon.lens_io.glasses.dispersion import glass_dispersion
from addon.sampling.chromatic import ChromaticAberration, Dispersion
from addon.sampling.equalizer import EQUALIZER_PRESETS
from addon.sampling.spectral_bands import band_levels, spectral_bands, spectral_length
from addon.sampling.spectral_samples import channel_density, wavelengths_for


def aberration(mode="SPECTRAL", equalizer="FLAT", axial=1.0, lateral=0.05):
    return ChromaticAberration(
        mode,
        axial,
        lateral,
        glass_dispersion("N-BK7"),
        0.05,
        equalizer=EQUALIZER_PRESETS[equalizer][1],
    )


def columns(bands):
    return (
        np.array([band.weights for band in bands]),
        np.array([band.dispersion for band in bands]),
    )


@pytest.mark.parametrize("equalizer", list(EQUALIZER_PRESETS))
@pytest.mark.parametrize("px", [0.0, 1.0, 50.0, 1e3, 1e5])
@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
def test_bands_have_all_the_light_of_each_channel(mode, px, equalizer):
    levels = band_levels(aberration(mode, equalizer), px, px, 16)
    for level in levels:
        weights, _ = columns(level.bands)
        assert weights.sum(axis=0) == pytest.approx([1.0] * 3, abs=1e-12)
        assert (weights >= 0.0).all()
        assert 1 <= len(level.bands) <= 16


@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
def test_bands_have_the_mean_focus_and_scale_of_the_samples(mode):
    shown = aberration(mode)
    weights, places = columns(spectral_bands(shown, 1e4, 1e3, 16))
    samples = wavelengths_for(shown, 3 * 11**3)
    for own, column in (
        (shown.focal_errors(samples.wavelengths_nm), 0),
        (shown.lateral_strengths(samples.wavelengths_nm), 1),
    ):
        expected = (samples.weights * own[:, None]).mean(axis=0)
        # The channels differ within a band.
        assert places[:, column] @ weights == pytest.approx(expected, abs=0.01 * np.ptp(own))


@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
def test_levels_are_for_all_lengths_up_to_the_longest(mode):
    for px, count in ((0.5, 1), (100.0, 3 if mode == "RGB" else 4), (1e5, 16)):
        levels = band_levels(aberration(mode), px, 0.0, 16)
        assert len(levels[-1].bands) == (min(count, 3) if mode == "RGB" else count)
        assert levels[0].least == 0.0 and levels[-1].most == np.inf
        assert [level.most for level in levels[:-1]] == [level.least for level in levels[1:]]
        length = spectral_length(aberration(mode), px, 0.0)
        assert levels[-1].least <= length
        if mode == "SPECTRAL" and count < 16:
            # Steps of a pixel and a half at the most.
            assert length / count <= 1.5


def test_an_even_light_is_as_long_as_its_way():
    flat = Dispersion((380.0, 780.0), (0.9, 1.0))
    narrow = ChromaticAberration("SPECTRAL", 1.0, 0.0, flat, 0.05, wavelength_range=(560.0, 562.0))
    errors = narrow.focal_errors(np.array([560.0, 562.0]))
    way = 1e5 * np.ptp(errors)
    assert spectral_length(narrow, 1e5, 0.0) == pytest.approx(way, rel=0.01)


@pytest.mark.parametrize(("equalizer", "bar"), [("FLAT", 0.02), ("WARM", 0.02), ("ENDS", 0.04)])
def test_rims_of_bands_add_up_to_those_of_all_wavelengths(equalizer, bar):
    """Light of discs of less than a radius, over the radius: each band's rim is a ramp."""
    shown = aberration(equalizer=equalizer)
    weights, places = columns(spectral_bands(shown, 1e6, 0.0, 16))
    density = channel_density(shown.wavelength_range, shown.equalizer, shown.primaries)
    middle = 0.5 * (density.edges_nm[1:] + density.edges_nm[:-1])
    error = shown.focal_errors(middle)
    radius = np.linspace(1.1 * error.min(), -0.1 * error.min(), 4001)
    ramps = np.clip((radius[:, None] - places[:, 0]) / np.maximum(places[:, 2], 1e-9) + 0.5, 0, 1)
    expected = np.stack(
        [np.interp(radius, error, np.cumsum(channel)) for channel in density.channels.T], axis=1
    )
    assert np.abs(ramps @ weights - expected).max() < bar
