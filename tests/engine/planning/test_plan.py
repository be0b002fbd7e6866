"""From snapshot to plan: region, circle of confusion, sharpness, neighbouring frames."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.engine.planning.plan import plan_frame, region_projection, sharp_radius
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import Camera
from addon.snapshot.content import InstanceTable, SceneContent
from addon.snapshot.film import Film, Sampling
from addon.snapshot.scene import SceneSnapshot

WIDTH, HEIGHT = 160, 90


def projection(parallel=False, far=100.0, near=0.1):
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1] = 2.0, 2.0 * WIDTH / HEIGHT
    if parallel:
        matrix[2, 2], matrix[2, 3] = -2.0 / (far - near), -(far + near) / (far - near)
        matrix[3, 3] = 1.0
    else:
        matrix[2, 2] = -(far + near) / (far - near)
        matrix[2, 3] = -2.0 * far * near / (far - near)
        matrix[3, 2] = -1.0
    return matrix


def snapshot(lens=None, region=(0, 0, WIDTH, HEIGHT), parallel=False, **camera):
    table = InstanceTable(np.zeros((0, 4, 4), np.float32), np.zeros(0, np.float32))
    return SceneSnapshot(
        content=SceneContent({}, {}, {}, table, ()),
        camera=Camera(np.eye(4), projection(parallel), lens, parallel, **camera),
        film=Film(WIDTH, HEIGHT, region, filter_kind="BOX", filter_size_px=1.0),
        sampling=Sampling("REFERENCE", 16, 0),
    )


def raster(matrix, point, width, height, origin=(0, 0)):
    clip = matrix @ np.array([*point, 1.0])
    return (clip[:2] / clip[3] + 1.0) / 2.0 * np.array([width, height]) + origin


@given(
    st.integers(0, 100),
    st.integers(0, 50),
    st.integers(1, 60),
    st.integers(1, 40),
    st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-20, -0.5)),
)
def test_a_point_of_the_region_lies_where_it_lies_in_the_whole_picture(x, y, w, h, point):
    film = Film(WIDTH, HEIGHT, (x, y, w, h))
    whole = raster(projection(), point, WIDTH, HEIGHT)
    part = raster(region_projection(projection(), film), point, w, h, (x, y))
    # float64, a few hundred pixels
    assert np.abs(whole - part).max() < 1e-9


def test_jitter_is_the_same_number_of_pixels_in_a_region():
    whole = plan_frame(snapshot())
    part = plan_frame(snapshot(region=(10, 20, 40, 30)))
    assert np.allclose(whole.jitter * [WIDTH, HEIGHT], part.jitter * [40, 30], atol=1e-12)


def test_without_lens_every_sample_looks_through_the_centre():
    plan = plan_frame(snapshot())
    assert (plan.lens_positions == 0.0).all()
    assert plan.coc_scale == 0.0
    assert plan.empty_coc == 0.0


def test_the_circle_of_confusion_of_infinity_is_the_limit():
    lens = ThinLens(0.1, 4.0)
    plan = plan_frame(snapshot(lens))
    depth = 1e9
    assert plan.empty_coc == pytest.approx(plan.coc_scale * (depth - 4.0) / (depth * 4.0), rel=1e-6)


def test_the_circle_of_confusion_of_nothing_is_finite_for_a_parallel_camera():
    lens = ThinLens(0.1, 4.0)
    plan = plan_frame(snapshot(lens, parallel=True))
    # That of the far plane at 100 m.
    assert plan.empty_coc == pytest.approx(plan.coc_scale * 96.0 / 4.0)


def test_a_sharp_circle_is_a_share_of_the_diagonal_but_at_least_a_pixel():
    assert sharp_radius(480, 270) == 0.5
    assert 2.0 * sharp_radius(3840, 2160) == pytest.approx(np.hypot(3840, 2160) / 1500.0)


def test_without_motion_the_neighbouring_frames_are_this_one():
    plan = plan_frame(snapshot(region=(10, 20, 40, 30)))
    assert np.allclose(plan.previous, plan.projection @ plan.view)
    assert np.allclose(plan.next, plan.previous)


def test_neighbouring_frames_are_seen_in_the_same_region():
    moved = np.eye(4)
    moved[0, 3] = -0.5
    shot = snapshot(region=(10, 20, 40, 30), previous=(moved, projection()))
    plan = plan_frame(shot)
    assert np.allclose(plan.previous, plan.projection @ moved)


def test_the_seed_moves_the_samples_and_nothing_else():
    shot = snapshot(ThinLens(0.1, 4.0))
    other = replace(shot, sampling=replace(shot.sampling, seed=5))
    first, second = plan_frame(shot), plan_frame(other)
    assert (first.lens_positions != second.lens_positions).any()
    assert (first.projection == second.projection).all()
