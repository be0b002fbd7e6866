import numpy as np
import pytest

from addon.errors import InputError
from addon.lens_bokeh.look.onion import (
    OnionRings,
    aspheric_surfaces,
    ring_contrast,
    rings_of_lens,
    transmission,
)
from addon.lens_bokeh.openings.masks import texel_centres
from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.paraxial import first_order
from addon.optics.rays.trace import Rays, trace

POINTS = texel_centres(256)


def test_rings_are_round_and_as_deep_as_asked():
    rings = OnionRings(contrast=0.2, pitch=0.1, irregularity=0.0)
    values = transmission(rings, POINTS)
    assert np.allclose(values, values.T) and np.allclose(values, values[::-1])
    assert values.max() == pytest.approx(1.2, abs=2e-3)
    assert values.min() == pytest.approx(0.8, abs=2e-3)


def test_even_rings_repeat_with_their_pitch():
    rings = OnionRings(contrast=0.2, pitch=0.1, irregularity=0.0)
    line = np.stack([np.linspace(0.0, 0.8, 81), np.zeros(81)], axis=-1)
    values = transmission(rings, line)
    assert np.allclose(values[:-10], values[10:], atol=1e-9)


def test_irregular_rings_are_no_jump_anywhere():
    line = np.stack([np.linspace(0.0, 1.2, 4001), np.zeros(4001)], axis=-1)
    values = transmission(OnionRings(0.3, 0.05, 1.0, seed=3), line)
    # Slope of the cosine plus those of depth and phase: a few times 2 pi contrast / pitch.
    assert np.abs(np.diff(values)).max() < 3 * 2 * np.pi * 0.3 / 0.05 * 1.2 / 4000
    assert values.min() >= 0.7 and values.max() <= 1.3


def test_the_centre_moves_with_the_field():
    rings = OnionRings(0.2, 0.2, 0.0, shift=-0.5)
    values = transmission(rings, POINTS, (0.4, 0.0))
    centred = transmission(OnionRings(0.2, 0.2, 0.0), POINTS + (0.2, 0.0))
    assert np.allclose(values, centred)


def test_rings_finer_than_texels_fade():
    rings = OnionRings(0.2, 0.01, 0.0)
    assert np.all(transmission(rings, POINTS, width=0.02) == 1.0)


def test_contrast_follows_the_lens_equation_of_a_ripple():
    # A groove of amplitude A and pitch p is a lens of power dn A (2 pi / p)^2.
    power = 0.6 * 1e-6 * (2 * np.pi / 0.45) ** 2
    distance = 10.0**2 / (587.5618e-6 * 100.0)
    assert ring_contrast(0.6, 10.0, 100.0) == pytest.approx(power * distance)
    assert ring_contrast(0.6, 10.0, 1e-9) == 1.0


def test_only_lenses_with_aspheres_have_turned_surfaces(shared):
    def found(name):
        lens = read_lens(shared / "lenses" / f"{name}.toml").prescription
        return aspheric_surfaces(lens.configuration())

    assert found("double-gauss-50mm-f2") == ()
    assert found("aspheric-30mm-f2") == (4,)


def test_rings_of_a_lens_are_centred_where_the_axis_of_its_asphere_is(shared):
    lens = read_lens(shared / "lenses" / "aspheric-30mm-f2.toml").prescription.configuration()
    rings = rings_of_lens(lens, 100.0)
    order = first_order(lens)
    # A point that the camera sees at height +t sends rays of slope -t. The one through the ring
    # centre meets the asphere (surface 4) on the axis, to third order in t.
    t = 0.01
    height = rings.shift * t * order.enp_diameter / 2.0
    direction = np.array([0.0, -t, 1.0]) / np.hypot(1.0, t)
    origin = np.array([0.0, height + t * order.enp_z, 0.0])
    hits = trace(lens, Rays([origin], [direction]), 587.5618, clip=False, record=True).hits
    assert abs(hits[3, 0, 1]) < 1e-4
    # And the pitch is that of the ripple where the marginal ray passes.
    marginal = Rays([[0.0, 0.01 * order.enp_diameter / 2.0, 0.0]], [[0.0, 0.0, 1.0]])
    hits = trace(lens, marginal, 587.5618, record=True).hits
    assert rings.pitch == pytest.approx(0.45 / (100.0 * hits[3, 0, 1]), rel=1e-3)
    spherical = read_lens(shared / "lenses" / "double-gauss-50mm-f2.toml").prescription
    assert rings_of_lens(spherical.configuration(), 100.0) is None


def test_values_out_of_range_are_refused():
    for wrong in (dict(contrast=1.5), dict(pitch=0.0), dict(irregularity=-1.0)):
        with pytest.raises(InputError, match=next(iter(wrong))):
            OnionRings(**wrong)
