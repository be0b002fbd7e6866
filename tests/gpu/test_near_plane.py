"""The near plane of the depth buffer: as far away as what is in view allows."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.near_plane import nearest_in_view, with_near_plane
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
    own, fitted = snapshot.camera.projection, with_near_plane(snapshot)
    assert (fitted[[0, 1, 3]] == own[[0, 1, 3]]).all()
    for projection, near in ((own, NEAR), (fitted, 2.5)):
        for depth, expected in ((near, -1.0), (100.0, 1.0)):
            clip = projection @ (0.0, 0.0, -depth, 1.0)
            assert clip[2] / clip[3] == pytest.approx(expected, abs=1e-6)
    assert plan_frame(snapshot).projection == pytest.approx(fitted)


def test_planes_stay_where_nothing_is_in_view_or_the_projection_is_parallel():
    empty = close_up([wall(-5.0)], [(1.0, 1.0, 1.0)])
    assert with_near_plane(empty) is empty.camera.projection
    parallel = triangles_snapshot([wall(5.0)], [(1.0, 1.0, 1.0)], WIDTH, HEIGHT, parallel=True)
    parallel = replace(
        parallel, camera=replace(parallel.camera, projection=orthographic(WIDTH, HEIGHT))
    )
    assert with_near_plane(parallel) is parallel.camera.projection
