"""Maps over the field of the picture."""

import numpy as np
import pytest

from addon.errors import InputError
from addon.sampling.field_maps import (
    ATOMS,
    CURVE_POINTS,
    FIELD_PRESETS,
    LIMIT,
    FieldMap,
    field_corner,
)
from benchmarks.reference.chromatic import field_coordinates

T = np.linspace(0.02, 0.98, 49)
THETA = np.linspace(-np.pi, np.pi, 49)
FORMULAS = {
    "IDENTITY": lambda t, theta: t,
    "T2": lambda t, theta: t**2,
    "T3": lambda t, theta: t**3,
    "EXP": lambda t, theta: np.exp(t),
    "ONE_MINUS": lambda t, theta: 1 - t,
    "RECIPROCAL": lambda t, theta: 1 / t,
    "COS_T": lambda t, theta: np.cos(2 * np.pi * t),
    "COS_THETA": lambda t, theta: np.cos(theta) + 0 * t,
    "T_COS_THETA": lambda t, theta: t * np.cos(theta),
    "CURVE": lambda t, theta: np.interp(t, [0, 0.5, 1], [0.2, 1.5, -0.3]),
}
CURVE = (0.2, 1.5, -0.3)


def test_every_atom_has_a_formula():
    assert set(FORMULAS) == set(ATOMS)


@pytest.mark.parametrize("g", ATOMS)
@pytest.mark.parametrize("f", ATOMS)
def test_second_atom_takes_what_the_first_gives(f, g):
    field_map = FieldMap(f, g, CURVE, CURVE)
    exact = FORMULAS[g](FORMULAS[f](T, THETA), THETA)
    inside = (np.abs(exact) < LIMIT) & (np.abs(FORMULAS[f](T, THETA)) < LIMIT)
    np.testing.assert_allclose(field_map(T, THETA)[inside], exact[inside], rtol=1e-12, atol=1e-15)
    assert not field_map.clamped_at(T, THETA)[inside].any()
    assert np.all(np.abs(field_map(T, THETA)) <= LIMIT)


def test_order_of_composition():
    # exp(1 - t) and 1 - exp(t): the dissertation's example and its opposite.
    np.testing.assert_allclose(FieldMap("ONE_MINUS", "EXP")(T), np.exp(1 - T))
    np.testing.assert_allclose(FieldMap("EXP", "ONE_MINUS")(T), 1 - np.exp(T))


@pytest.mark.parametrize(
    "field_map, pole, near",
    [
        (FieldMap("RECIPROCAL"), 0.0, 0.02),
        (FieldMap("ONE_MINUS", "RECIPROCAL"), 1.0, 0.98),
        (FieldMap("COS_T", "RECIPROCAL"), 0.25, 0.2),
        (FieldMap("RECIPROCAL", "EXP"), 0.0, 0.5),
    ],
)
def test_singular_points_are_clamped_and_say_so(field_map, pole, near):
    assert field_map.clamped
    assert abs(field_map(pole)) == LIMIT
    assert field_map.clamped_at(pole) and not field_map.clamped_at(near)
    assert np.all(np.isfinite(field_map.table()))


def test_regular_maps_are_not_clamped():
    assert not any(FieldMap(name).clamped for name in ATOMS if name != "RECIPROCAL")


def test_outside_the_picture_counts_as_its_corner():
    assert FieldMap("T2")(1.7) == 1.0
    assert FieldMap("T2")(-0.1) == 0.0


def test_table_holds_the_map():
    plain = FieldMap("T2", "EXP").table(65)
    assert plain.shape == (1, 65) and plain.dtype == np.float32
    np.testing.assert_allclose(plain[0], np.exp(np.linspace(0, 1, 65) ** 2), rtol=1e-6)
    angular = FieldMap("T2", "T_COS_THETA").table(65, 33)
    assert angular.shape == (33, 65)
    np.testing.assert_allclose(angular[:, -1], np.cos(np.linspace(-np.pi, np.pi, 33)), atol=1e-6)
    # The seam behind the axis closes.
    np.testing.assert_allclose(angular[0], angular[-1], atol=1e-6)


def test_table_between_its_points_is_the_map():
    # 256 columns and 128 rows, interpolated linearly: the second derivatives of the regular atoms
    # are at most (2 pi)^2, over 8 and over 255 squared.
    field_map = FieldMap("COS_T")
    table = field_map.table()[0]
    t = np.linspace(0.0, 1.0, 1001)
    between = np.interp(t, np.linspace(0, 1, table.size), table)
    np.testing.assert_allclose(between, field_map(t), atol=(2 * np.pi) ** 2 / 8 / 255**2 * 1.01)


def test_curve_is_level_beyond_its_ends():
    drawn = FieldMap("EXP", "CURVE", curve_g=tuple(np.linspace(0.0, 0.7, CURVE_POINTS)))
    assert drawn(0.5) == pytest.approx(0.7)


def test_presets_are_named_pairs_of_maps():
    for label, axial, lateral in FIELD_PRESETS.values():
        assert label and axial.text and lateral.text
    _, axial, lateral = FIELD_PRESETS["SHOWCASE"]
    assert axial == lateral and axial.text == "1/(1 \u2212 t)"
    assert axial(0.75) == pytest.approx(4.0)


def test_formulas_read_as_formulas():
    assert FieldMap("EXP", "ONE_MINUS").text == "1 \u2212 exp(t)"
    assert FieldMap("ONE_MINUS", "T2").text == "(1 \u2212 t)\u00b2"
    assert FieldMap("T2", "T3").text == "(t\u00b2)\u00b3"
    assert FieldMap("T2", "COS_THETA").text == "cos(\u03b8)"
    assert FieldMap("CURVE", "EXP").text == "exp(curve(t))"
    assert FieldMap("T2", "COS_T").text == "cos(2\u03c0 (t\u00b2))"


def test_unknown_atoms_and_short_curves_are_refused():
    with pytest.raises(InputError, match="'SIN'"):
        FieldMap("SIN")
    with pytest.raises(InputError, match="two or more values"):
        FieldMap("CURVE", curve_f=(1.0,))
    with pytest.raises(InputError, match="finite"):
        FieldMap("CURVE", curve_f=(1.0, np.nan))


def perspective(x, y, shift=(0.0, 0.0)):
    return np.array([[x, 0, shift[0], 0], [0, y, shift[1], 0], [0, 0, -1.02, -0.2], [0, 0, -1, 0]])


def test_tilt_is_the_angle_of_the_chief_ray_over_that_of_the_corner():
    corner = field_corner(perspective(2.0, 3.0))
    assert corner == pytest.approx(np.arctan(np.hypot(1 / 2, 1 / 3)))
    depth = 7.0
    points = np.array([[0, 0, -depth], [depth / 2, depth / 3, -depth], [0, depth / 3, -depth]])
    t, theta = field_coordinates(points, corner)
    np.testing.assert_allclose(t, [0.0, 1.0, np.arctan(1 / 3) / corner], atol=1e-12)
    assert theta[0] == 0.0 and theta[2] == pytest.approx(np.pi / 2)
    # Beyond the picture, and behind the camera.
    t, _ = field_coordinates(np.array([[9.0, 0, -1.0], [1.0, 0, 5.0]]), corner)
    np.testing.assert_array_equal(t, 1.0)


def test_a_shifted_picture_has_its_axis_off_the_middle():
    # Shift moves the picture to clip x = -shift on the axis: the far corner lies farther out.
    shifted = field_corner(perspective(2.0, 3.0, (0.5, 0.0)))
    assert shifted == pytest.approx(np.arctan(np.hypot(1.5 / 2, 1 / 3)))


def test_orthographic_field_is_a_distance():
    projection = np.diag([0.25, 0.5, -0.02, 1.0])
    corner = field_corner(projection, True)
    assert corner == pytest.approx(np.hypot(4.0, 2.0))
    t, _ = field_coordinates(np.array([[2.0, 1.0, -33.0]]), corner, True)
    assert t[0] == pytest.approx(0.5)
