"""The oracle of the bokeh profile: rings of one meridian are what the whole pupil gives."""

import numpy as np
import pytest

from addon.lens_io.toml.toml_reader import read_lens
from benchmarks.reference.traced_bokeh import (
    focused_lens,
    picture_of_rings,
    psnr,
    traced_cone,
    traced_picture,
    traced_rings,
)

PIXELS = 32


@pytest.mark.parametrize("name", ["double-gauss-50mm-f2", "petzval-51mm-f1.4"])
@pytest.mark.parametrize(("distance", "focus"), [(600.0, 2000.0), (5000.0, 2000.0)])
def test_rings_are_the_picture_of_the_whole_pupil(shared, name, distance, focus):
    lens = read_lens(shared / f"lenses/{name}.toml").prescription.configuration()
    lens = focused_lens(lens, focus)
    cone = traced_cone(lens, distance, lens.f_number, rays=1 << 16)
    rings = traced_rings(cone, lens.sensor, rings=8 * PIXELS)
    counted = traced_picture(lens, distance, lens.f_number, rings.extent, PIXELS, 1 << 19)
    assert counted.sum() == pytest.approx(1.0, abs=1e-3)
    # Counting some 150 rays in a pixel is right to about a hundredth.
    assert psnr(counted, picture_of_rings(rings.energy, PIXELS)) > 36.0


def test_picture_of_an_even_disk_has_its_area():
    rings = np.diff(np.linspace(0.0, 1.0, 257) ** 2)
    picture = picture_of_rings(rings, PIXELS)
    assert picture.sum() == pytest.approx(1.0, rel=1e-3)
    assert picture[16, 16] == pytest.approx(1.0 / (np.pi * 16**2), rel=1e-3)
    np.testing.assert_array_equal(picture, picture[::-1, ::-1])
    np.testing.assert_allclose(picture, picture.T)
