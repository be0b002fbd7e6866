"""The planes of the depth buffer: as close round what is in view as that allows."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.depth_planes import farthest_in_view, nearest_in_view, with_fitted_planes
from addon.engine.planning.plan import plan_frame
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens

from .conftest import orthographic, perspective, render_snapshot, triangles_snapshot

WIDTH, HEIGHT = 24, 16
NEAR = 0.002


def close_up(corners, colors, lens=None, near=NEAR, **options):
    snapshot = triangles_snapshot(corners, colors, WIDTH, HEIGHT, lens, 4, **options)
    projection = perspective(WIDTH, HEIGHT, near=near)
    return replace(snapshot, camera=replace(snapshot.camera, projection=projection))


def wall(depth):
    """A triangle across the view that fills the picture."""
    return np.array([(-60.0, -40.0, -depth), (60.0, -40.0, -depth), (0.0, 80.0, -depth)])


def test_surfaces_a_fraction_of_a_millimetre_apart_are_told_apart(gpu_context):
    # With the camera's own near plane of 2 mm, the one behind was seen in half of the pixels.
    green, red = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
    picture = render_snapshot(close_up([wall(5.0), wall(4.9997)], [green, red]))["Combined"]
    assert (picture[..., 1] == 0.0).all()
    assert picture[..., 0] == pytest.approx(1.0)


def test_it_does_not_depend_on_the_clip_start(gpu_context):
    scene = [wall(5.0), 0.02 * wall(3.0)], [(0.2, 0.4, 0.6), (0.7, 0.1, 0.3)]
    lens = ThinLens(0.05, 4.0, Iris())
    pictures = [
        render_snapshot(close_up(*scene, lens, near))["Combined"].tobytes() for near in (NEAR, 0.05)
    ]
    assert pictures[0] == pictures[1]


def floor_under_the_camera():
    """A floor 1 m below that reaches far behind; the view is 1/3 steep downwards."""
    return np.array([(-500.0, -1.0, 300.0), (500.0, -1.0, 300.0), (0.0, -1.0, -900.0)])


def test_what_lies_behind_and_below_does_not_count():
    pinhole = close_up([floor_under_the_camera()], [(1.0, 1.0, 1.0)])
    assert 2.0 < nearest_in_view(pinhole, NEAR) < 3.0
    # Places on the lens see a little more of it.
    lens = close_up([floor_under_the_camera()], [(1.0, 1.0, 1.0)], ThinLens(0.3, 4.0, Iris()))
    assert 1.0 < nearest_in_view(lens, NEAR) < nearest_in_view(pinhole, NEAR)


@pytest.mark.parametrize("radius", [0.0, 0.1, 0.4])
def test_no_lens_sample_sees_anything_nearer(radius):
    rng = np.random.default_rng(5)
    lens = ThinLens(radius, 2.0, Iris(ratio=1.5)) if radius else None
    for _ in range(50):
        corners = rng.normal(0.0, 1.5, (1, 3, 3)) * (1.0, 1.0, 2.0)
        snapshot = close_up(corners, [(1.0, 1.0, 1.0)], lens)
        weights = rng.dirichlet((1.0, 1.0, 1.0), 4000)
        points = weights @ corners[0].astype(np.float32)
        points = points[points[:, 2] < -NEAR]
        angle, away = rng.uniform(0.0, 2.0 * np.pi, len(points)), np.sqrt(rng.random(len(points)))
        on_lens = radius * away[:, None] * np.stack([np.cos(angle) / 1.5, np.sin(angle)], axis=1)
        seen = points[:, :2] - on_lens * (1.0 + points[:, 2:] / 2.0)
        clip = seen * np.diag(snapshot.camera.projection)[:2]
        visible = (np.abs(clip) <= -points[:, 2:]).all(axis=1)
        nearest = -points[visible, 2].max(initial=-np.inf)
        assert nearest_in_view(snapshot, NEAR) <= nearest


def test_the_far_plane_and_the_picture_stay_where_they_are():
    snapshot = close_up([wall(5.0)], [(1.0, 1.0, 1.0)])
    own, fitted = snapshot.camera.projection, with_fitted_planes(snapshot)
    assert (fitted[[0, 1, 3]] == own[[0, 1, 3]]).all()
    for projection, near in ((own, NEAR), (fitted, 2.5)):
        for depth, expected in ((near, -1.0), (100.0, 1.0)):
            clip = projection @ (0.0, 0.0, -depth, 1.0)
            assert clip[2] / clip[3] == pytest.approx(expected, abs=1e-6)
    assert plan_frame(snapshot).projection == pytest.approx(fitted)


def parallel_view(corners, clip_end, lens=None):
    snapshot = triangles_snapshot(
        corners, [(1.0, 1.0, 1.0)] * len(corners), WIDTH, HEIGHT, lens, 64, parallel=True
    )
    projection = orthographic(WIDTH, HEIGHT)
    near = (projection[2, 3] + 1.0) / projection[2, 2]
    projection[2, 2:] = -2.0 / (clip_end - near), -(clip_end + near) / (clip_end - near)
    return replace(snapshot, camera=replace(snapshot.camera, projection=projection))


def test_planes_stay_where_nothing_is_in_view():
    empty = close_up([wall(-5.0)], [(1.0, 1.0, 1.0)])
    assert with_fitted_planes(empty) is empty.camera.projection
    empty = parallel_view([wall(-5.0)], 100.0)
    assert with_fitted_planes(empty) is empty.camera.projection


def test_the_far_plane_of_a_parallel_view_lies_behind_all_that_it_shows():
    snapshot = parallel_view([wall(5.0), wall(7.0) + (900.0, 0.0, -60.0)], 100.0)
    near = (snapshot.camera.projection[2, 3] + 1.0) / snapshot.camera.projection[2, 2]
    # The second wall is beside the picture.
    assert farthest_in_view(snapshot, near) == pytest.approx(5.0)
    clip = with_fitted_planes(snapshot) @ (0.0, 0.0, -(5.0 + 0.1 * (5.0 - near)), 1.0)
    assert clip[2] / clip[3] == pytest.approx(1.0, abs=1e-6)


def test_what_is_empty_in_a_parallel_view_is_blurred_by_no_clip_end():
    lens = ThinLens(0.5, 2.0, Iris())
    blurs = [
        plan_frame(parallel_view([wall(5.0)], clip_end, lens)).empty_coc
        for clip_end in (10.0, 10000.0)
    ]
    # Depths are single precision; it was a thousand times as wide.
    assert blurs[1] == pytest.approx(blurs[0], rel=1e-3)
