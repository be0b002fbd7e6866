"""Energy of a fan of rays in rings."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from addon.lens_bokeh.tables.radial_energy import ring_energy

PUPIL = np.linspace(0.0, 1.0, 1025)
EDGES = np.linspace(0.0, 1.0, 65)
AREAS = np.pi * np.diff(EDGES**2)


def test_perfect_cone_is_an_even_disk():
    np.testing.assert_allclose(ring_energy(PUPIL, PUPIL, EDGES), AREAS, rtol=1e-12)
    # Behind the focus the same, upside down.
    np.testing.assert_allclose(ring_energy(-PUPIL, PUPIL, EDGES), AREAS, rtol=1e-12)


@given(
    arrays.arrays(np.float64, 40, elements=st.floats(-1.0, 1.0)),
    arrays.arrays(np.float64, 40, elements=st.floats(0.0, 1.0)),
)
def test_no_energy_is_lost_or_made(heights, steps):
    heights[0] = 0.0
    radii = np.concatenate([[0.0], np.cumsum(steps)[:-1]])
    edges = np.linspace(0.0, 0.7, 12)
    total = ring_energy(heights, radii, edges).sum()
    assert total == pytest.approx(np.pi * radii[-1] ** 2, rel=1e-12, abs=1e-15)


def test_all_rays_in_one_point_fill_the_innermost_ring():
    energy = ring_energy(np.zeros(50), np.linspace(0.0, 2.0, 50), np.linspace(0.0, 1e-9, 9))
    assert energy.sum() == pytest.approx(4.0 * np.pi)


def test_caustic_has_its_closed_form():
    # y = rho - rho^3 turns at 1 / sqrt(3). Rays with |y| < r: those up to the first root of
    # y = r, and those beyond the second one; the whole fan ends at y = 0.
    heights = PUPIL - PUPIL**3
    edges = np.linspace(0.0, 0.36, 25)
    inside = np.empty(len(edges))
    for i, r in enumerate(edges):
        _, first, second = np.sort(np.roots([1.0, 0.0, -1.0, r]).real)
        inside[i] = first**2 + 1.0 - second**2
    inside[0] = 0.0
    found = ring_energy(heights, PUPIL, edges)
    # The last ring holds the little that lies beyond 0.36 too.
    # Between the rays the curve is straight: some 1e-6 of each.
    np.testing.assert_allclose(found[:-1], np.pi * np.diff(inside)[:-1], atol=6e-6)


def test_fan_through_the_axis_agrees_with_counted_rays():
    heights = PUPIL**3 - 0.4 * PUPIL
    edges = np.linspace(0.0, 0.6, 31)
    pupil = np.sqrt((np.arange(400_000) + 0.5) / 400_000)
    radii = np.abs(pupil**3 - 0.4 * pupil)
    counted = np.pi * np.histogram(radii, edges)[0] / len(pupil)
    # A ray at each of the four edges of a ring may fall on either side, and the fan is straight
    # between its rays.
    np.testing.assert_allclose(ring_energy(heights, PUPIL, edges), counted, atol=3e-5)
