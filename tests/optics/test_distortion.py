import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from addon.errors import InputError
from addon.optics.distortion import distorted, fitted_terms, is_invertible, undistorted

POINTS = np.stack(np.meshgrid(np.linspace(-0.7, 0.7, 9), np.linspace(-0.6, 0.8, 9)), axis=-1)


@given(st.floats(-0.5, 0.5), st.floats(-0.1, 0.1), st.floats(-0.05, 0.05))
def test_inverse_undoes_the_model(k1, k2, k3):
    centre, terms = (0.1, -0.05), (k1, k2, k3)
    assume(is_invertible(terms, 1.2))
    assert np.allclose(
        distorted(undistorted(POINTS, terms, centre), terms, centre), POINTS, rtol=0, atol=1e-10
    )


def test_equation_of_the_paper():
    d = np.array([0.3, 0.4])
    assert np.allclose(undistorted(d, (-0.1,)), d / (1.0 - 0.1 * 0.25))


def test_one_term_has_a_closed_inverse():
    radius = np.linspace(0.0, 0.9, 31)
    for k in (-0.4, -0.01, 0.2):
        found = distorted(np.stack([radius, 0.0 * radius], axis=-1), (k,))[:, 0]
        exact = 2.0 * radius / (1.0 + np.sqrt(1.0 - 4.0 * k * radius**2))
        assert np.allclose(found, exact, rtol=1e-13, atol=0)


def test_barrel_draws_points_inwards_and_pincushion_outwards():
    corner = np.array([0.6, 0.6])
    assert np.hypot(*distorted(corner, (-0.2,))) < np.hypot(*corner)
    assert np.hypot(*distorted(corner, (0.2,))) > np.hypot(*corner)


def test_zero_changes_nothing():
    assert np.array_equal(undistorted(POINTS, (0.0, 0.0)), POINTS)
    assert np.allclose(distorted(POINTS, (0.0, 0.0)), POINTS, rtol=1e-15, atol=0)


def test_what_a_picture_cannot_show_stays_finite():
    far = distorted(np.array([[3.0, 0.0], [100.0, 100.0]]), (0.4,))
    # The model turns round at radius 1 / sqrt(K).
    assert np.allclose(np.hypot(far[:, 0], far[:, 1]), 1.0 / np.sqrt(0.4), rtol=1e-6)


@pytest.mark.parametrize("terms", [(-0.4,), (0.4,), (0.1, 0.0, 0.05)])
def test_a_picture_that_would_fold_is_refused(terms):
    with pytest.raises(InputError, match="radius"):
        undistorted(np.array([2.0, 0.0]), terms)


def test_fit_finds_the_coefficients_and_scale_of_a_distortion():
    u = np.linspace(0.0, 0.9, 12)
    d = distorted(np.stack([1.02 * u, 0 * u], axis=-1), (-0.15,))[:, 0]
    (k,), scale = fitted_terms(u, d)
    assert k == pytest.approx(-0.15, abs=1e-10) and scale == pytest.approx(1.02, abs=1e-10)
    terms = (-0.15, 0.06, -0.02)
    d = distorted(np.stack([u, 0 * u], axis=-1), terms)[:, 0]
    found, scale = fitted_terms(u, d, 3, scaled=False)
    assert np.allclose(found, terms, rtol=0, atol=1e-9) and scale == 1.0
    with pytest.raises(InputError):
        fitted_terms(np.zeros(4), np.zeros(4))
