"""The real lens of a picture: what is around the camera's own picture changes nothing in it."""

import numpy as np
import pytest

from addon.engine.planning.lens_plan import plan_real_lens
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import Camera
from addon.snapshot.film import Film
from tests.splat_pictures import library_lens

THIN = ThinLens(0.05 / 2.8, 4.0)
# 36 x 24 mm at 50 mm, and the corner's tangent.
SIDES, CORNER = np.array([36.0, 24.0]) / 50.0, np.hypot(18.0, 12.0) / 50.0


def plan(times, lens="planar-50mm-f1.4", field_radius=None):
    """Plan a picture that shows so many times the camera's own one along each side."""
    projection = np.diag([*(2.0 / (times * SIDES)), -1.0, 0.0])
    projection[2, 3], projection[3, 2] = -0.2, -1.0
    camera = Camera(
        np.eye(4), projection, THIN, real_lens=library_lens(lens), field_radius=field_radius
    )
    return plan_real_lens(camera, Film(96, 64, (0, 0, 96, 64)), THIN)


def test_around_a_cameras_picture_the_light_is_that_of_its_corner():
    own, report = plan(1.0)
    around, told = plan(2.0, field_radius=CORNER)
    assert report == told == ()
    assert not around.is_dark
    away = np.hypot(*around.grid.nodes.T).reshape(around.base.shape)
    beyond = around.base[away > 1.01 * CORNER]
    assert beyond.min() == pytest.approx(own.base[0, 0], rel=0.1)
    assert beyond.max() < 1.5 * beyond.min()


def test_a_picture_larger_than_the_lens_covers_is_told():
    found, report = plan(2.0)
    assert found.is_dark
    assert "next to no light" in report[0]
