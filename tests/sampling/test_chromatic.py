"""Focus and magnification by wavelength."""

from decimal import Decimal, getcontext

import numpy as np
import pytest

from addon.errors import InputError
from addon.optics.glass import ConstantGlass, SellmeierGlass
from addon.sampling.chromatic import (
    LEAST_SCALE,
    ChromaticAberration,
    Dispersion,
    chromatic_focus,
    dispersion_of_focal_lengths,
    dispersion_of_glass,
    lateral_scale,
)
from addon.sampling.field_maps import FieldMap

# N-BK7, Schott's data sheet: B1 to B3, then C1 to C3 in um^2.
BK7 = ["1.03961212", "0.231792344", "1.01046945", "0.00600069867", "0.0200179144", "103.560653"]
FOCAL_LENGTH = 0.05
WAVELENGTHS = np.linspace(383.0, 777.0, 20)


def bk7():
    numbers = tuple(map(float, BK7))
    return dispersion_of_glass(SellmeierGlass(numbers[:3], numbers[3:]))


def aberration(mode="SPECTRAL", axial=1.0, lateral=0.05, **others):
    others = {"dispersion": bk7(), "focal_length": FOCAL_LENGTH} | others
    return ChromaticAberration(mode, axial, lateral, **others)


def exact_focal_length(wavelength_nm, reference_nm):
    """Equations (4.3) and (4.4) to 50 digits."""
    getcontext().prec = 50

    def power(nm):
        square = (Decimal(repr(float(nm))) / 1000) ** 2
        terms = zip(BK7[:3], BK7[3:], strict=True)
        return (1 + sum(Decimal(b) * square / (square - Decimal(c)) for b, c in terms)).sqrt() - 1

    return Decimal(repr(FOCAL_LENGTH)) * power(reference_nm) / power(wavelength_nm)


def exact_focus(focus, focal_length_at):
    """Equation (4.5) as it is printed."""
    longest, distance = Decimal(repr(FOCAL_LENGTH)), Decimal(repr(focus))
    divisor = longest * distance - focal_length_at * distance + focal_length_at * longest
    return longest * distance * focal_length_at / divisor


@pytest.mark.parametrize("focus", [0.4, 3.0, 40.0])
@pytest.mark.parametrize("mode", ["SPECTRAL", "RGB"])
def test_focus_over_wavelength_is_equation_4_5(focus, mode):
    model = aberration(mode)
    reference = {"SPECTRAL": 780.0, "RGB": 650.0}[mode]
    wavelengths = WAVELENGTHS[reference >= WAVELENGTHS]
    found = model.focus_distances(focus, wavelengths)
    exact = [exact_focus(focus, exact_focal_length(nm, reference)) for nm in wavelengths]
    np.testing.assert_allclose(found, np.array(exact, float), rtol=1e-6)
    assert model.focus_distances(focus, reference) == pytest.approx(focus, rel=1e-12)
    assert np.all(np.diff(found) > 0.0)


@pytest.mark.parametrize("focus", [0.4, 3.0, 40.0])
@pytest.mark.parametrize("axial", [0.3, 1.0, -0.05])
def test_focus_over_the_field_is_equations_4_5_and_4_7(focus, axial):
    # A strength moves the focal length from that of the reference, then the field moves it back.
    model = aberration(axial=axial, axial_map=FieldMap("T2"))
    for t in (0.0, 0.35, 0.9, 1.0):
        for nm in WAVELENGTHS:
            longest = Decimal(repr(FOCAL_LENGTH))
            whole = longest + Decimal(repr(axial)) * (exact_focal_length(nm, 780.0) - longest)
            share = Decimal(repr(t)) ** 2
            exact = exact_focus(focus, whole * (1 - share) + longest * share)
            if exact < 0 or exact > 1000 * focus:
                # Beyond infinity, or so near it that the digits of a double are gone.
                continue
            assert model.focus_distances(focus, nm, t) == pytest.approx(float(exact), rel=1e-6)


def test_lateral_scale_is_equation_4_8():
    model = aberration(lateral=0.07, lateral_map=FieldMap("ONE_MINUS", "RECIPROCAL"))
    for t in (0.0, 0.3, 0.8):
        found = model.lateral_scales(WAVELENGTHS, t)
        np.testing.assert_allclose(
            found, 1.0 + 0.07 * (0.780 - WAVELENGTHS / 1000.0) / (1.0 - t), rtol=1e-12
        )
    assert model.lateral_scales(780.0, 0.8) == 1.0
    strengths = model.lateral_strengths(WAVELENGTHS)
    np.testing.assert_allclose(1.0 + strengths / (1.0 - 0.8), found, rtol=1e-12)


def test_off_axis_the_standard_map_leaves_the_reference_focus():
    model = aberration()
    np.testing.assert_allclose(model.focus_distances(3.0, WAVELENGTHS, 1.0), 3.0, rtol=1e-12)
    np.testing.assert_allclose(model.lateral_scales(WAVELENGTHS, 0.0), 1.0)


def test_no_strength_is_no_aberration():
    model = aberration(axial=0.0, lateral=0.0)
    np.testing.assert_array_equal(model.focal_errors(WAVELENGTHS), 0.0)
    np.testing.assert_array_equal(model.lateral_strengths(WAVELENGTHS), 0.0)
    np.testing.assert_allclose(model.focus_distances(3.0, WAVELENGTHS), 3.0, rtol=1e-14)
    assert model.problems() == ()


def test_negative_strength_turns_the_order_of_colours_round():
    here, there = aberration(axial=0.1, lateral=0.02), aberration(axial=-0.1, lateral=-0.02)
    places = (2.0, [400.0, 550.0, 700.0])
    assert np.all(np.diff(here.focus_distances(*places)) > 0.0)
    assert np.all(np.diff(there.focus_distances(*places)) < 0.0)
    assert np.all(here.lateral_scales(places[1], 0.5) > 1.0)
    assert np.all(there.lateral_scales(places[1], 0.5) < 1.0)


def test_beyond_the_condition_4_6_the_blur_goes_on():
    lengths = FOCAL_LENGTH * np.linspace(1.0, 1.01, 2001)
    vergences = 1.0 / chromatic_focus(40.0, FOCAL_LENGTH, lengths)
    # The focus passes infinity; its vergence falls on and on.
    assert vergences[0] > 0.0 > vergences[-1] and np.all(np.diff(vergences) < 0.0)
    assert vergences[-1] == pytest.approx(1.0 / 40.0 - 1.0 / FOCAL_LENGTH * (1.0 - 1.0 / 1.01))


def test_extreme_strengths_stay_finite():
    for axial, lateral in ((1e6, 1e6), (-1e6, -1e6)):
        model = aberration(axial=axial, lateral=lateral, axial_map=FieldMap("RECIPROCAL"))
        t = np.linspace(0.0, 1.0, 33)[:, None]
        assert np.all(model.lateral_scales(WAVELENGTHS, t) >= LEAST_SCALE)
        assert np.isfinite(1.0 / model.focus_distances(3.0, WAVELENGTHS, t)).all()
    assert lateral_scale(400.0, 780.0, -100.0, 1.0) == LEAST_SCALE
    (problem,) = aberration(axial=0.0, lateral=-3.0).problems()
    assert "inside out" in problem


def test_a_glass_without_dispersion_says_so():
    assert not dispersion_of_glass(ConstantGlass(1.5)).disperses
    assert bk7().disperses


def test_ratio_is_that_of_the_longest_wavelength_or_of_another():
    dispersion = bk7()
    assert dispersion.ratio(830.0) == pytest.approx(1.0)
    assert dispersion.ratio(650.0, 650.0) == pytest.approx(1.0, abs=1e-15)
    exact = exact_focal_length(487.3, 650.0) / Decimal(repr(FOCAL_LENGTH))
    assert dispersion.ratio(487.3, 650.0) == pytest.approx(float(exact), rel=1e-11)


def test_few_points_are_joined_by_their_polynomial():
    two = dispersion_of_focal_lengths([400.0, 800.0], [45.0, 50.0])
    assert two.ratio(600.0) == pytest.approx(0.95)
    cubic = np.poly1d([1e-10, -2e-7, 2e-4, 0.9])
    places = np.array([400.0, 450.0, 520.0, 610.0, 700.0])
    curve = Dispersion(tuple(places), tuple(cubic(places)))
    between = np.linspace(400.0, 700.0, 41)
    np.testing.assert_allclose(curve.ratio(between), cubic(between) / cubic(700.0), rtol=1e-12)
    assert curve.ratio(900.0) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"mode": "CMYK"}, "mode 'CMYK'"),
        ({"axial": np.nan}, "finite"),
        ({"focal_length": 0.0}, "greater than 0"),
        ({"wavelength_range": (780.0, 380.0)}, "must rise"),
        ({"wavelength_range": (100.0, 780.0)}, "inside 360 to 830"),
    ],
)
def test_what_forms_no_picture_is_refused(change, message):
    with pytest.raises(InputError, match=message):
        aberration(**change)


@pytest.mark.parametrize(
    "places, ratios",
    [((500.0,), (1.0,)), ((500.0, 400.0), (1.0, 1.0)), ((400.0, 500.0), (-1.0, 1.0))],
)
def test_curves_that_are_no_dispersion_are_refused(places, ratios):
    with pytest.raises(InputError):
        Dispersion(places, ratios)


def test_equal_settings_are_equal_and_can_be_keys():
    assert aberration() == aberration()
    assert len({aberration(), aberration(), aberration(axial=2.0)}) == 2
