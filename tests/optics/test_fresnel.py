"""Reflection at surfaces: energy, and textbook values."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.errors import PrescriptionError
from addon.optics.fresnel import Coating, energies, transmittance

COSINES = np.linspace(0.0, 1.0, 101)
INDEX = st.floats(1.0, 4.0)


@given(INDEX, INDEX)
def test_bare_surface_loses_no_energy(before, behind):
    reflected, transmitted = energies(COSINES, before, behind)
    np.testing.assert_allclose(reflected + transmitted, 1.0, atol=1e-13)
    assert (reflected >= 0.0).all() and (transmitted >= 0.0).all()


@given(INDEX, INDEX, INDEX, st.floats(300.0, 900.0))
def test_coated_surface_loses_no_energy(before, behind, layer, nm):
    coating = Coating(layer, 550.0, cemented=True)
    reflected, transmitted = energies(COSINES, before, behind, coating, nm)
    # At grazing incidence on a layer in which the wave fades, digits cancel.
    np.testing.assert_allclose(reflected + transmitted, 1.0, atol=1e-9)


@given(INDEX, INDEX, st.floats(1.0, 4.0), st.floats(0.05, 1.0), st.floats(400.0, 700.0))
def test_transmission_is_the_same_both_ways(before, behind, layer, cosine, nm):
    # Stokes: the same ray backwards, along the refracted direction.
    sine = before / behind * math.sqrt(1.0 - cosine * cosine)
    if sine > 0.999:
        return
    back = math.sqrt(1.0 - sine * sine)
    coating = Coating(layer, 550.0, cemented=True)
    there = transmittance(np.array(cosine), before, behind, coating, nm)
    again = transmittance(np.array(back), behind, before, coating, nm)
    assert there == pytest.approx(again, abs=1e-9)


def test_glass_reflects_four_percent():
    reflected, _ = energies(np.array(1.0), 1.0, 1.5)
    assert reflected == pytest.approx(0.04, abs=1e-15)


def test_half_is_left_at_brewsters_angle():
    # Only s is reflected there: R_s = ((n^2 - 1) / (n^2 + 1))^2.
    n = 1.5
    cosine = 1.0 / math.sqrt(1.0 + n * n)
    reflected, _ = energies(np.array(cosine), 1.0, n)
    assert reflected == pytest.approx(0.5 * ((n * n - 1) / (n * n + 1)) ** 2, abs=1e-15)


def test_total_reflection_lets_nothing_through():
    beyond = math.cos(math.asin(1.0 / 1.5) + 1e-6)
    reflected, transmitted = energies(np.array([beyond, 0.0]), 1.5, 1.0)
    np.testing.assert_array_equal(reflected, 1.0)
    np.testing.assert_array_equal(transmitted, 0.0)


def test_quarter_wave_of_the_root_of_the_index_reflects_nothing():
    coating = Coating(math.sqrt(1.52), 550.0)
    reflected, transmitted = energies(np.array(1.0), 1.0, 1.52, coating, 550.0)
    assert reflected == pytest.approx(0.0, abs=1e-30)
    assert transmitted == pytest.approx(1.0, abs=1e-14)


def test_magnesium_fluoride_on_crown():
    # ((n0 n2 - n1^2) / (n0 n2 + n1^2))^2 at the design wavelength; 1.26 % for 1.38 on 1.52.
    reflected, _ = energies(np.array(1.0), 1.0, 1.52, Coating(1.38, 550.0), 550.0)
    assert reflected == pytest.approx(((1.52 - 1.38**2) / (1.52 + 1.38**2)) ** 2, rel=1e-12)
    assert reflected == pytest.approx(0.0126, abs=5e-5)


def test_half_wave_layer_is_not_there():
    # A quarter wave of 1100 nm is half a wave of 550 nm.
    bare, _ = energies(np.array(1.0), 1.0, 1.52)
    coated, _ = energies(np.array(1.0), 1.0, 1.52, Coating(1.38, 1100.0), 550.0)
    assert coated == pytest.approx(bare, abs=1e-15)


def test_layer_of_the_index_of_the_glass_is_bare_glass():
    bare = transmittance(COSINES, 1.0, 1.52)
    coated = transmittance(COSINES, 1.0, 1.52, Coating(1.52, 550.0), 500.0)
    np.testing.assert_allclose(coated, bare, atol=1e-12)


def test_cemented_faces_have_no_layer_unless_asked():
    bare = transmittance(COSINES, 1.5, 1.7)
    np.testing.assert_array_equal(transmittance(COSINES, 1.5, 1.7, Coating(), 550.0), bare)
    asked = transmittance(COSINES, 1.5, 1.7, Coating(cemented=True), 550.0)
    assert np.abs(asked - bare).max() > 1e-3


def test_equal_media_do_not_reflect():
    coating = Coating(cemented=True)
    np.testing.assert_array_equal(transmittance(COSINES, 1.5, 1.5, coating, 550.0), 1.0)


@pytest.mark.parametrize("values", [{"index": 0.0}, {"index": math.nan}, {"wavelength_nm": -1.0}])
def test_layers_that_are_none_are_refused(values):
    with pytest.raises(PrescriptionError, match="coating"):
        Coating(**values)
