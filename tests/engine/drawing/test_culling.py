"""Culling never leaves out what a sample can see, and runs cover what is seen."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.engine.drawing import culling
from addon.engine.planning.plan import plan_frame
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import InstanceGroup, InstanceTable, SceneContent
from benchmarks.reference.rasterize import displace

from ..planning.test_plan import snapshot


def spheres_of(points):
    """Bounding spheres of single points."""
    world = np.tile(np.eye(4, dtype=np.float32), (len(points), 1, 1))
    world[:, :3, 3] = points
    table = InstanceTable(world, np.zeros(len(points), np.float32))
    content = SceneContent({}, {}, {}, table, (InstanceGroup(1, (), 0, len(points)),))
    return culling.BoundingSpheres(content, {1: np.zeros((2, 3))})


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_points_that_a_sample_sees_are_never_left_out(seed, parallel):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-6, 6, (400, 3)).astype(np.float32).astype(np.float64)
    lens = ThinLens(float(rng.uniform(0, 0.5)), float(rng.uniform(0.5, 8)), Iris(6, 0.2, 1.5))
    plan = plan_frame(snapshot(lens, parallel=parallel))
    seen = culling.seen(spheres_of(points), plan)
    for place, jitter in zip(plan.lens_positions, plan.jitter, strict=True):
        moved = displace(points, place, plan.focus_distance)
        clip = np.concatenate([moved, np.ones((len(points), 1))], axis=1) @ plan.projection.T
        clip[:, :2] += jitter * clip[:, 3:]
        inside = (np.abs(clip[:, :3]) <= clip[:, 3:]).all(axis=1)
        assert not (inside & ~seen).any()


def test_much_of_what_is_outside_is_left_out():
    rng = np.random.default_rng(1)
    points = rng.uniform(-6, 6, (1000, 3))
    plan = plan_frame(snapshot(ThinLens(0.05, 3.0)))
    # The frustum fills about a fourteenth of the cube.
    assert culling.seen(spheres_of(points), plan).mean() < 0.2


def test_a_sphere_holds_its_mesh_under_any_scale():
    rng = np.random.default_rng(2)
    world = np.tile(np.eye(4), (50, 1, 1))
    world[:, :3] = rng.normal(size=(50, 3, 4)) * 3
    bounds = np.array([[-1.0, -2.0, 0.0], [2.0, 0.5, 3.0]])
    table = InstanceTable(world.astype(np.float32), np.zeros(50, np.float32))
    content = SceneContent({}, {}, {}, table, (InstanceGroup(1, (), 0, 50),))
    spheres = culling.BoundingSpheres(content, {1: bounds})
    corners = np.array(np.meshgrid(*bounds.T)).reshape(3, -1).T
    placed = np.einsum("nij,cj->nci", table.world[:, :3, :3], corners) + table.world[:, None, :3, 3]
    distance = np.linalg.norm(placed - spheres.centers[:, None], axis=-1).max(axis=1)
    assert (distance <= spheres.radii * (1 + 1e-6)).all()


@given(st.lists(st.booleans(), min_size=1, max_size=60), st.integers(1, 500))
def test_runs_hold_every_row_and_nothing_else_than_small_gaps(flags, triangles):
    wanted = np.flatnonzero(flags)
    runs = culling.runs(wanted, triangles)
    rows = [row for start, length in runs for row in range(start, start + length)]
    assert len(rows) == len(set(rows))
    assert set(wanted) <= set(rows)
    assert all(wanted[0] <= row <= wanted[-1] for row in rows)
    drawn_in_vain = len(rows) - len(wanted)
    assert drawn_in_vain * triangles <= 100 * max(len(wanted) - len(runs), 0)


def test_runs_without_gaps_hold_nothing_else():
    assert culling.runs(np.array([1, 2, 4, 7, 8]), np.inf) == [(1, 2), (4, 1), (7, 2)]


def test_no_row_is_no_run():
    assert culling.runs(np.array([], int), 10) == []
