"""Bands of wavelengths: all the light, few bands, rims where the wavelengths have them."""

import numpy as np
import pytest

from addon.lens_io.dispersion import glass_dispersion
from addon.sampling.chromatic import ChromaticAberration
from addon.sampling.equalizer import EQUALIZER_PRESETS
from addon.sampling.spectral_bands import merged_bands, spectral_bands
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
    bands = spectral_bands(aberration(mode, equalizer), px, px, 24)
    weights, _ = columns(bands)
    assert weights.sum(axis=0) == pytest.approx([1.0] * 3, abs=1e-12)
    assert (weights >= 0.0).all()
    assert 1 <= len(bands) <= 24
    assert columns(merged_bands(bands, 4))[0].sum(axis=0) == pytest.approx([1.0] * 3, abs=1e-12)


@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
def test_bands_have_the_mean_focus_and_scale_of_the_samples(mode):
    shown = aberration(mode)
    weights, places = columns(spectral_bands(shown, 1e4, 1e3, 24))
    samples = wavelengths_for(shown, 3 * 11**3)
    for own, column in (
        (shown.focal_errors(samples.wavelengths_nm), 0),
        (shown.lateral_strengths(samples.wavelengths_nm), 1),
    ):
        expected = (samples.weights * own[:, None]).mean(axis=0)
        # Of the range of the three means; the channels differ within a band.
        assert places[:, column] @ weights == pytest.approx(expected, abs=0.01 * np.ptp(own))


def test_where_colors_hardly_part_there_is_one_band():
    assert len(spectral_bands(aberration(), 1.0, 0.5, 24)) == 1
    assert len(spectral_bands(aberration("RGB"), 1.0, 0.5, 24)) == 1
    assert len(spectral_bands(aberration("RGB"), 100.0, 0.5, 24)) == 3
    counts = [len(spectral_bands(aberration(), px, 0.0, 1000)) for px in (30, 100, 300, 1000)]
    assert counts == sorted(counts) and counts[-1] > 2 * counts[1] > 4


@pytest.mark.parametrize(("equalizer", "bar"), [("FLAT", 0.01), ("WARM", 0.015), ("ENDS", 0.02)])
def test_rims_of_bands_add_up_to_those_of_all_wavelengths(equalizer, bar):
    """Light of discs of less than a radius, over the radius: each band's rim is a ramp."""
    shown = aberration(equalizer=equalizer)
    weights, places = columns(spectral_bands(shown, 1e6, 0.0, 24))
    density = channel_density(shown.wavelength_range, shown.equalizer, shown.primaries)
    middle = 0.5 * (density.edges_nm[1:] + density.edges_nm[:-1])
    error = shown.focal_errors(middle)
    radius = np.linspace(1.1 * error.min(), -0.1 * error.min(), 4001)
    ramps = np.clip((radius[:, None] - places[:, 0]) / np.maximum(places[:, 2], 1e-9) + 0.5, 0, 1)
    expected = np.stack(
        [np.interp(radius, error, np.cumsum(channel)) for channel in density.channels.T], axis=1
    )
    assert np.abs(ramps @ weights - expected).max() < bar


def test_joined_bands_keep_mean_and_variance():
    bands = spectral_bands(aberration(), 1e5, 1e3, 24)
    few = merged_bands(bands, 1)
    (alone,) = spectral_bands(aberration(), 0.0, 0.0, 24)
    assert np.array(few[0].dispersion) == pytest.approx(np.array(alone.dispersion), rel=1e-6)
    assert merged_bands(bands, 24) == bands
