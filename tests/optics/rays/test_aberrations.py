"""Aberrations: laws, limits, and a singlet's textbook values."""

import math

import numpy as np
import pytest

from addon.optics.glass import AIR, ConstantGlass
from addon.optics.prescription import Configuration, Surface
from addon.optics.rays.aberrations import (
    axial_focus,
    best_focus,
    field_curves,
    paraxial_focus,
    spot,
)

F_NUMBER, HALF_FIELD = 10.0, 10.0


def singlet(stop_before=0.0, n=1.5, radius=50.0):
    """Return a plano-convex lens, its stop at a distance before it, curved side to the scene."""
    surfaces = (
        Surface(math.inf, stop_before, 5.0, AIR, is_stop=True),
        Surface(radius, 4.0, 20.0, ConstantGlass(n)),
        Surface(math.inf, 97.0, 20.0, AIR),
    )
    return Configuration(surfaces, 100.0, F_NUMBER, HALF_FIELD)


def test_longitudinal_aberration_starts_at_the_paraxial_focus():
    found = axial_focus(singlet(), [0.0, 1e-3, 1.0])
    assert found.shift[0] == 0.0
    assert abs(found.shift[1]) < 1e-5
    assert found.shift[2] < -0.1


def test_longitudinal_aberration_grows_with_the_square_of_the_height():
    found = axial_focus(singlet(), [0.1, 0.2])
    # Third order; the next order is a thousandth of it here.
    assert found.shift[1] / found.shift[0] == pytest.approx(4.0, rel=5e-3)


def test_longitudinal_aberration_of_a_thin_plano_convex_lens_is_the_textbook_value():
    # Jenkins and White, Fundamentals of Optics, section 9.5: with q = 1, p = -1.
    n, focal_length, height = 1.5, 100.0, 1.0
    surfaces = (
        Surface(50.0, 1e-6, 5.0, ConstantGlass(n), is_stop=True),
        Surface(math.inf, 100.0, 5.0, AIR),
    )
    lens = Configuration(surfaces, focal_length, F_NUMBER, HALF_FIELD)
    q, p = 1.0, -1.0
    bending = (n + 2) / (n - 1) * q**2 + 4 * (n + 1) * p * q
    bending += (3 * n + 2) * (n - 1) * p**2 + n**3 / (n - 1)
    expected = -(height**2) / (8 * focal_length * n * (n - 1)) * bending
    found = axial_focus(lens, [height / 5.0])
    assert found.shift[0] == pytest.approx(expected, rel=2e-3)


def test_blocked_rays_are_left_out():
    lens = singlet()
    found = axial_focus(lens, [0.0, 0.5, 1.5])
    assert found.rho.tolist() == [0.0, 0.5]


def test_best_focus_lies_before_the_paraxial_one_of_an_uncorrected_lens():
    lens = singlet()
    marginal = axial_focus(lens, [1.0]).shift[0]
    best = best_focus(lens) - paraxial_focus(lens)
    assert marginal < best < 0.0
    sizes = [
        np.median(np.hypot(*spot(lens, 0.0, best_focus(lens) + step).T))
        for step in (-0.02, 0.0, 0.02)
    ]
    assert sizes[1] == min(sizes)


def test_spot_is_mirror_symmetric_to_the_plane_of_the_field():
    points = spot(singlet(5.0), 8.0, 100.0)
    mirrored = points * (-1.0, 1.0)
    assert np.allclose(np.sort(points[:, 0]), np.sort(mirrored[:, 0]), atol=1e-9)
    assert points[:, 1].mean() > 10.0


def test_a_stop_in_front_makes_a_barrel_and_foci_meet_on_the_axis():
    curves = field_curves(singlet(10.0), [0.0, 5.0, 10.0])
    assert curves.distortion[0] == 0.0
    assert 0.0 > curves.distortion[1] > curves.distortion[2]
    # Third order: distortion as the square of the field.
    assert curves.distortion[2] / curves.distortion[1] == pytest.approx(4.0, rel=0.05)
    assert curves.tangential[0] == pytest.approx(curves.sagittal[0], abs=1e-6)
    assert abs(curves.tangential[0]) < 1e-5


def test_astigmatism_near_the_axis_is_three_to_one_about_the_petzval_surface():
    # Third order: tangential - petzval = 3 (sagittal - petzval); the Petzval surface of a singlet
    # has radius -n f for a thin lens.
    n, field = 1.5, 1.0
    lens = singlet(0.0, n)
    curves = field_curves(lens, [0.0, field])
    tangential, sagittal = curves.tangential[1], curves.sagittal[1]
    petzval = -(curves.height[1] ** 2) / (2.0 * n * 100.0)
    assert (tangential - petzval) / (sagittal - petzval) == pytest.approx(3.0, rel=1e-2)


def test_a_fisheye_is_measured_by_its_own_rule():
    lens = singlet(0.0)
    flat, fisheye = (field_curves(lens, [10.0], rule) for rule in ("rectilinear", "fisheye"))
    angle = math.radians(10.0)
    assert (1 + fisheye.distortion[0]) / (1 + flat.distortion[0]) == pytest.approx(
        math.tan(angle) / angle
    )


def test_a_field_that_no_ray_reaches_is_left_out():
    assert field_curves(singlet(), [0.0, 89.9]).field_deg[0] == 0.0
    assert len(spot(singlet(100.0), 60.0, 100.0)) == 0
