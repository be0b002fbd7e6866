"""Chromatic displacement of points."""

import numpy as np
import pytest

from addon.lens_io.glasses.dispersion import glass_dispersion
from addon.sampling.chromatic import ChromaticAberration
from addon.sampling.field_maps import FieldMap
from benchmarks.reference.chromatic import displaced, field_coordinates

CORNER = np.arctan(0.6)
FOCUS = 3.0
POINTS = np.array([[0.0, 0.0, -2.0], [0.3, -0.2, -2.0], [1.5, 0.4, -9.0], [-0.7, 0.1, -3.0]])
LENS = np.array([0.011, -0.007])


def aberration(axial, lateral, **others):
    return ChromaticAberration("SPECTRAL", axial, lateral, glass_dispersion(), 0.05, **others)


def test_without_strength_it_is_the_thin_lens():
    found = displaced(POINTS, LENS, 440.0, aberration(0.0, 0.0), FOCUS, CORNER)
    # Of a lens of radius 1: the cone from the lens to the point in focus.
    radius = 1.0 + POINTS[:, 2] / FOCUS
    np.testing.assert_allclose(found[:, :2], POINTS[:, :2] - LENS * radius[:, None])
    np.testing.assert_array_equal(found[:, 2], POINTS[:, 2])


def test_axial_aberration_moves_the_plane_in_focus_and_nothing_else():
    model = aberration(1.0, 0.0)
    in_focus = float(model.focus_distances(FOCUS, 500.0))
    points = np.array([[0.0, 0.0, -in_focus]])
    np.testing.assert_allclose(displaced(points, LENS, 500.0, model, FOCUS, CORNER), points)
    center = displaced(POINTS, np.zeros(2), 500.0, model, FOCUS, CORNER)
    np.testing.assert_allclose(center, POINTS)


def test_lateral_aberration_scales_about_the_axis():
    model = aberration(0.0, 0.08, lateral_map=FieldMap("T2"))
    found = displaced(POINTS, np.zeros(2), 480.0, model, FOCUS, CORNER)
    t, _ = field_coordinates(POINTS, CORNER)
    np.testing.assert_allclose(found[:, :2], POINTS[:, :2] * (1 + 0.08 * 0.3 * t**2)[:, None])


@pytest.mark.parametrize("orthographic", [False, True])
def test_shapes_broadcast(orthographic):
    wavelengths = np.array([[400.0], [500.0], [600.0]])
    found = displaced(POINTS, LENS, wavelengths, aberration(1.0, 0.1), FOCUS, CORNER, orthographic)
    assert found.shape == (3, 4, 3) and np.all(np.isfinite(found))
