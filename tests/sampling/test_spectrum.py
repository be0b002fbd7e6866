"""Colour of wavelengths."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from addon.errors import InputError
from addon.sampling.spectrum import (
    color_matching,
    rgb_weights,
    spectrum_wavelengths,
    xyz_to_rgb,
)

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


def test_table_is_the_librarys():
    import colour

    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    # The table's own wavelengths: nothing is interpolated, so that only its written digits differ.
    wavelengths = np.arange(380.0, 781.0)
    np.testing.assert_allclose(color_matching(wavelengths), observer[wavelengths], atol=1e-12)


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


def test_table_of_the_observer_has_the_published_sums():
    # Of the table in steps of 1 nm, which each of its 1413 numbers takes part in.
    published = [106.865469, 106.856917, 106.892251]
    total = color_matching(np.arange(360.0, 831.0)).sum(axis=0)
    np.testing.assert_allclose(total, published, atol=1e-5)


def test_matrix_is_the_one_of_the_standard():
    # IEC 61966-2-1, amendment 1, to its seven digits; its white is not rounded alike: 1e-4.
    published = [
        [3.2406255, -1.5372080, -0.4986286],
        [-0.9689307, 1.8757561, 0.0415175],
        [0.0557101, -0.2040211, 1.0569959],
    ]
    np.testing.assert_allclose(xyz_to_rgb("ITU-R BT.709"), published, atol=4e-4)


@pytest.mark.parametrize("name", ["ITU-R BT.709", "ITU-R BT.2020", "ACEScg"])
def test_white_of_a_space_is_equal_parts_of_its_primaries(name):
    x, y = (0.32168, 0.33767) if name == "ACEScg" else (0.3127, 0.3290)
    white = np.array([x / y, 1.0, (1.0 - x - y) / y])
    np.testing.assert_allclose(xyz_to_rgb(name) @ white, 1.0, atol=1e-12)


def test_nothing_large_is_imported_for_colors():
    # Importing a library of colours, and with it one of plots, took a sixth of a first picture.
    code = (
        "import sys\n"
        f"sys.path.insert(0, {str(REPOSITORY)!r})\n"
        "import numpy\n"
        "before = set(sys.modules)\n"
        "from addon.sampling.spectrum import rgb_weights, spectrum_wavelengths\n"
        "rgb_weights(spectrum_wavelengths())\n"
        "new = {name.partition('.')[0] for name in set(sys.modules) - before}\n"
        "assert not new - set(sys.stdlib_module_names) - {'addon'}, new\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
