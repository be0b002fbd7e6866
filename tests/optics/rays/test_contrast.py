"""Contrast of lines through a lens: against transfers that are known in closed form."""

import numpy as np
import pytest

from addon.lens_io.lens_shelf import LensShelf
from addon.optics.rays import contrast as module
from addon.optics.rays.contrast import contrast


def lens(name):
    return LensShelf([]).find(name).lens.prescription.configuration(None)


def test_an_evenly_lit_disc_has_the_transfer_of_one():
    # Of a disc of radius r: 2 J1(z) / z with z = 2 pi f r; J1 by its integral.
    frequency, radius = 30.0, 0.011
    z = 2.0 * np.pi * frequency * radius
    angle = np.linspace(0.0, np.pi, 2001)
    bessel = np.trapezoid(np.cos(angle - z * np.sin(angle)), angle) / np.pi
    side = (np.arange(201) + 0.5) / 201 * 2.0 - 1.0
    places = radius * np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    places = places[np.hypot(*places.T) <= radius]
    rays = places, np.zeros_like(places), np.full(len(places), 1.0 / len(places))
    # 30,000 points fill the disc to a few thousandths.
    np.testing.assert_allclose(module._kept(rays, 0.0, frequency), 2.0 * bessel / z, atol=0.005)


def test_a_lens_stopped_down_is_as_sharp_as_diffraction_lets_it():
    # Of an f/4 achromat at f/22 nothing but diffraction is left on the axis: 1 - 4 v / pi for
    # small v, the frequency over the cut-off.
    found = contrast(lens("achromat-100mm-f4"), [0.0], 10.0, 22.0)[0]
    share = 10.0 * 22.0 * 587.5618e-6
    assert found == pytest.approx(1.0 - 4.0 * share / np.pi, abs=0.02)


def test_the_middle_is_alike_in_both_directions_and_stopping_down_sharpens():
    planar = lens("planar-50mm-f1.4")
    fields = [0.0, 0.7 * planar.half_field_deg]
    wide, stopped = (contrast(planar, fields, 30.0, number) for number in (None, 4.0))
    assert wide[0, 0] == pytest.approx(wide[0, 1], abs=1e-3)
    assert (stopped[0] > wide[0] + 0.2).all() and (stopped < 1.0).all()
    # Coarse lines keep more.
    assert (contrast(planar, fields, 10.0) > wide).all()
    # Focus goes along where it shifts with the opening: by millimetres in a soft lens.
    soft = lens("soft-focus-85mm-f2.8")
    assert contrast(soft, [0.0], 30.0, 8.0)[0, 0] > 2.0 * contrast(soft, [0.0], 30.0)[0, 0]
