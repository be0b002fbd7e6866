"""Rays of a lens with cylinders: where it shows the points in focus."""

import numpy as np
import pytest

from addon.lens_bokeh.samples.cylinder_rays import Distortion

FIELDS = (np.linspace(0.0, 0.4, 6), np.linspace(0.0, 0.2, 5))


@pytest.fixture
def distortion():
    x, y = np.meshgrid(*FIELDS, indexing="ij")
    shift = -0.1 * np.stack([x, y], axis=-1) * (x**2 + 2.0 * y**2)[..., None]
    return Distortion(FIELDS, shift)


def test_the_fields_of_places_are_shown_at_those_places(distortion):
    places = np.random.default_rng(1).uniform(-0.2, 0.2, (40, 2))
    shown = distortion.done(distortion.undone(places))
    # Splines of 11 x 9 nodes through a cubic.
    assert shown == pytest.approx(places, abs=1e-6)


def test_no_places_have_no_fields(distortion):
    # None of the rays of a field comes through, at f/0.01 far off the axis.
    assert distortion.undone(np.zeros((0, 2))).shape == (0, 2)
