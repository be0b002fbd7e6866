"""Colour of wavelengths."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from addon.errors import InputError
from addon.sampling.spectrum import color_matching, rgb_weights, spectrum_wavelengths

REPOSITORY = Path(__file__).resolve().parents[2]


def test_twenty_five_wavelengths_ten_nanometres_apart():
    wavelengths = spectrum_wavelengths()
    assert wavelengths[0] == 440.0 and wavelengths[-1] == 680.0
    np.testing.assert_allclose(np.diff(wavelengths), 10.0, atol=1e-12)


def test_color_matching_is_the_published_observer():
    # CIE 015 table of the 1931 observer at 450, 550, 600 nm.
    published = [
        [0.3362, 0.0380, 1.77211],
        [0.43344990, 0.9949501, 0.0087499],
        [1.0622, 0.631, 0.0008],
    ]
    np.testing.assert_allclose(color_matching([450.0, 550.0, 600.0]), published, atol=1e-4)


def test_flat_spectrum_is_white():
    for count in (7, 25, 100):
        weights = rgb_weights(spectrum_wavelengths(count))
        np.testing.assert_allclose(weights.sum(axis=0), 1.0, atol=1e-12)


def test_no_wavelength_takes_light_away():
    assert np.all(rgb_weights(np.linspace(400.0, 700.0, 61)) >= 0.0)


def test_each_channel_is_brightest_where_the_eye_says():
    wavelengths = spectrum_wavelengths(241)
    red, green, blue = wavelengths[np.argmax(rgb_weights(wavelengths), axis=0)]
    assert 590.0 < red < 625.0
    assert 520.0 < green < 555.0
    assert 440.0 <= blue < 465.0


def test_weights_follow_the_primaries_asked_for():
    wide = rgb_weights(spectrum_wavelengths(), "ITU-R BT.2020")
    narrow = rgb_weights(spectrum_wavelengths())
    assert np.abs(wide - narrow).max() > 0.01
    own = rgb_weights(spectrum_wavelengths(), np.eye(3))
    xyz = color_matching(spectrum_wavelengths())
    np.testing.assert_allclose(own, xyz / xyz.sum(axis=0))


def test_wavelengths_without_blue_are_refused():
    with pytest.raises(InputError, match="have no (green|blue)"):
        rgb_weights([690.0, 700.0])


def test_unknown_color_space_is_refused():
    with pytest.raises(InputError, match="not known"):
        rgb_weights([550.0], "Kodachrome")


def test_works_silently_without_scipy_and_leaves_no_stand_in():
    code = (
        "import sys\n"
        "class Hide:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.partition('.')[0] == 'scipy': raise ModuleNotFoundError(name)\n"
        "sys.meta_path.insert(0, Hide())\n"
        f"sys.path.insert(0, {str(REPOSITORY)!r})\n"
        "from addon.sampling.spectrum import rgb_weights, spectrum_wavelengths\n"
        "assert 'colour' not in sys.modules\n"
        "print(rgb_weights(spectrum_wavelengths()).sum())\n"
        "assert not [n for n in sys.modules if n.startswith('scipy')]\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(3.0)
