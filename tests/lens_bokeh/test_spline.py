import numpy as np
import pytest

from addon.lens_bokeh.tables.spline import cubic_taps, spline_matrix, spline_values


def cubic(x):
    return 0.3 * x**3 - x**2 + 2.0 * x - 1.0


def test_spline_is_exact_for_cubics_even_outside():
    nodes = np.array([-1.0, 0.0, 0.4, 1.5, 2.0])
    at = np.linspace(-1.5, 2.5, 50)
    assert np.allclose(spline_matrix(nodes, at) @ cubic(nodes), cubic(at), atol=1e-11)


def test_spline_goes_through_its_nodes():
    nodes = np.linspace(0.0, 1.0, 9)
    assert np.allclose(spline_matrix(nodes, nodes), np.eye(9), atol=1e-13)


@pytest.mark.parametrize("function", [lambda x: np.sin(3.0 * x), np.exp])
def test_spline_converges_with_the_fourth_power(function):
    at = np.linspace(0.0, 1.0, 333)
    errors = []
    for count in (17, 33):
        nodes = np.linspace(0.0, 1.0, count)
        errors.append(np.abs(spline_matrix(nodes, at) @ function(nodes) - function(at)).max())
    assert errors[0] / errors[1] > 12.0


def test_local_cubics_are_exact_for_parabolas_on_the_whole_grid():
    values = (np.arange(7) - 2.5) ** 2
    at = np.linspace(0.0, 6.0, 61)
    taps, weights = cubic_taps(at, 7)
    assert np.allclose(weights.sum(axis=0), 1.0)
    assert np.allclose((weights * values[taps]).sum(axis=0), (at - 2.5) ** 2)


def test_local_cubics_go_straight_on_outside():
    values = np.array([0.0, 1.0, 4.0, 9.0])
    taps, weights = cubic_taps(np.array([-2.0, 5.0]), 4)
    assert np.allclose((weights * values[taps]).sum(axis=0), [-2.0, 9.0 + 2 * 5.0])


def test_values_of_a_spline_are_those_of_its_matrix():
    rng = np.random.default_rng(5)
    nodes = np.cumsum(rng.uniform(0.2, 1.0, 11))
    values, at = rng.normal(size=11), rng.uniform(nodes[0] - 0.5, nodes[-1] + 0.5, 200)
    expected = spline_matrix(nodes, at) @ values
    assert np.allclose(spline_values(nodes, values, at), expected, atol=1e-12)
