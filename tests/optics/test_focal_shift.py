"""Focus of a lens over wavelength."""

from pathlib import Path

import numpy as np
import pytest

from addon.errors import PrescriptionError
from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.focal_shift import equivalent_focal_lengths
from addon.optics.glass import AIR, SellmeierGlass
from addon.optics.paraxial import first_order, image_distance
from addon.optics.prescription import Configuration, Surface

LENSES = Path(__file__).resolve().parents[2] / "lens_profiles"
WAVELENGTHS = np.array([400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0])
GLASS = SellmeierGlass(
    (1.03961212, 0.231792344, 1.01046945), (0.00600069867, 0.0200179144, 103.560653)
)


def singlet(thickness, front=50.0, back=-50.0):
    surfaces = (
        Surface(front, thickness, 10.0, GLASS, is_stop=True),
        Surface(back, 50.0, 10.0, AIR),
    )
    return Configuration(surfaces, 50.0, 4.0, 10.0)


def test_a_thin_singlet_follows_its_index():
    found = equivalent_focal_lengths(singlet(1e-6), WAVELENGTHS)
    power = GLASS.index(WAVELENGTHS) - 1.0
    np.testing.assert_allclose(found / found[-1], power[-1] / power, rtol=1e-7)


@pytest.mark.parametrize("name", ["achromat-100mm-f4", "double-gauss-50mm-f2", "biogon-21mm-f4.5"])
def test_the_thin_lens_is_in_focus_where_the_lens_is(name):
    configuration = read_lens(LENSES / f"{name}.toml").prescription.configuration(None)
    found = equivalent_focal_lengths(configuration, WAVELENGTHS)
    sensor = first_order(configuration, WAVELENGTHS[-1]).bfl
    shifted = 0
    for wavelength, focal in zip(WAVELENGTHS[:-1], found[:-1], strict=True):
        vergence = 1.0 / focal - 1.0 / found[-1]
        own = first_order(configuration, wavelength)
        # From the first principal plane; beyond infinity where it is negative.
        distance = 1.0 / vergence - own.h
        image = image_distance(configuration, distance, wavelength)
        assert image == pytest.approx(sensor, rel=1e-9)
        shifted += abs(sensor - own.bfl) > 1e-3
    assert shifted > 3


def test_a_lens_that_scatters_has_no_focus():
    with pytest.raises(PrescriptionError, match="does not collect"):
        equivalent_focal_lengths(singlet(2.0, -50.0, 50.0), WAVELENGTHS)
