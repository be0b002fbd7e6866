"""Levels of detail: the mapping from blur to triangles, and who draws which level when."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.levels import choosing
from addon.levels.making.level_errors import LevelErrors
from addon.levels.making.mesh_levels import MeshLevel
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import MeshSnapshot
from addon.snapshot.film import Sampling

from ..engine.planning.test_plan import snapshot

FOCUS = 4.0


def plan_for(lens=None, **sampling):
    frame = snapshot(lens or ThinLens(0.1, FOCUS))
    return plan_frame(replace(frame, sampling=Sampling("ADAPTIVE", 32, **sampling)))


def seen_box(depth, radius=0.2, length=0.0):
    as_rows = [np.array([value]) for value in (depth - length / 2, depth + length / 2, depth)]
    return choosing.Extents(*as_rows, np.array([radius]))


def test_a_triangle_as_large_as_the_blur_is_level_zero_and_each_quarter_two_more():
    plan = plan_for()
    depth = 10.0
    blur = np.pi * choosing.coc_radius(depth, plan) ** 2
    scale = plan.projection[1, 1] * plan.height / 2.0
    area = np.pi * (scale * 0.2 / depth) ** 2
    # As many triangles, seen from both sides, as circles of confusion fit into the object.
    triangles = np.array([area / blur / 0.5])
    bias = 0.0
    box = seen_box(depth)
    assert choosing.choose_levels(box, triangles, plan, bias)[0] == pytest.approx(0.0, abs=1e-9)
    assert choosing.choose_levels(box, 4 * triangles, plan, bias)[0] == pytest.approx(2.0)
    assert choosing.choose_levels(box, 4 * triangles, plan, bias + 1.0)[0] == pytest.approx(1.0)


def test_what_is_partly_in_focus_keeps_full_detail():
    plan = plan_for()
    many = np.array([1e7])
    assert choosing.choose_levels(seen_box(FOCUS + 1.0, length=2.5), many, plan)[0] == 0.0
    assert choosing.choose_levels(seen_box(FOCUS + 1.0, length=1.0), many, plan)[0] > 0.0


def test_what_reaches_behind_the_camera_keeps_full_detail():
    assert choosing.choose_levels(seen_box(0.5, length=1.5), np.array([1e7]), plan_for())[0] == 0.0


def test_a_pinhole_has_no_levels():
    plan = plan_for(ThinLens(0.0, FOCUS))
    assert choosing.choose_levels(seen_box(10.0), np.array([1e7]), plan)[0] == 0.0


def test_triangles_of_the_blurred_area_cover_a_circle_of_confusion_in_the_picture():
    plan = plan_for()
    depth = np.array([FOCUS, 6.0, 10.0, 1.5, -2.0])
    world = np.diag([2.0, 2.0, 2.0, 1.0])
    area = choosing.blurred_area(depth, world, plan, 0.0)
    # Twice as large in the world, seen at an average angle.
    scale = plan.projection[1, 1] * plan.height / 2.0
    seen = 0.5 * area * 4.0 * (scale / depth) ** 2
    circle = np.pi * choosing.coc_radius(depth, plan) ** 2
    assert seen[1:4] == pytest.approx(circle[1:4])
    assert area[0] == area[4] == 0.0, "in focus, and behind the camera"
    assert choosing.blurred_area(depth, world, plan, 1.0) == pytest.approx(area / 2.0)


def test_more_blur_never_means_more_detail():
    triangles = np.array([1e6])
    radii = (0.01, 0.02, 0.05, 0.1, 0.3)
    chosen = [
        choosing.choose_levels(seen_box(9.0), triangles, plan_for(ThinLens(r, FOCUS)))[0]
        for r in radii
    ]
    assert chosen == sorted(chosen)
    assert chosen[-1] > chosen[0]


def test_the_first_share_of_the_samples_draws_the_finer_level():
    drawn = [choosing.level_for_sample(np.array([2.3]), i, 10)[0] for i in range(10)]
    assert drawn == [2] * 7 + [3] * 3


def test_a_whole_level_is_drawn_by_all_samples():
    assert {int(choosing.level_for_sample(np.array([3.0]), i, 16)[0]) for i in range(16)} == {3}


def test_both_levels_share_the_lens_evenly():
    plan = plan_for()
    chosen = np.array([choosing.level_for_sample(np.array([1.5]), i, 32)[0] for i in range(32)])
    for level in (1, 2):
        center = plan.lens_positions[chosen == level].mean(axis=0)
        # The centre of 16 points of the sequence lies within a tenth of the radius.
        assert np.linalg.norm(center) < 0.1 * 0.1


def mesh_and_levels(*errors):
    """A mesh of 4096 triangles and levels of it with given errors."""
    positions = np.float32([[-1, -1, -1], [1, 1, 1], [1, -1, 1]])
    triangles = np.tile(np.int32([[0, 1, 2]]), (4096, 1))
    mesh = MeshSnapshot(1, "mesh", positions, triangles, ((0, 0, 4096),))
    made = [MeshLevel(2, "mesh", positions, triangles, ((0, 0, 4096),), errors=e) for e in errors]
    return (mesh, *made)


def test_levels_without_errors_follow_the_size_of_their_triangles():
    wanted = choosing.blur_for_levels(*mesh_and_levels(*[LevelErrors()] * 3))
    assert wanted == pytest.approx([1.5, 2.5, 3.5])
    chosen = choosing.allowed_levels(np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.5, 9.0]), wanted)
    assert chosen == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.5, 3.0, 3.0], abs=1e-5)


def test_a_level_waits_for_the_blur_that_hides_its_errors():
    calm, wild = LevelErrors(), LevelErrors(color=0.015**2)
    assert wild.blur == pytest.approx(1.0)
    wanted = choosing.blur_for_levels(*mesh_and_levels(calm, wild, wild))
    # A circle of diameter 1 against triangles that fill the sphere round the box.
    needed = np.log2(np.pi / 4.0 / (np.pi * 3.0 / (0.5 * 4096)))
    assert wanted == pytest.approx([1.5, needed, needed])
    chosen = choosing.allowed_levels(np.array([1.5, needed - 0.01, needed + 0.01]), wanted)
    assert chosen[0] == pytest.approx(1.0, abs=1e-4)
    assert 1.9 < chosen[1] < 2.0
    assert chosen[2] == pytest.approx(3.0, abs=1e-4)


def test_more_blur_never_draws_a_finer_level():
    errors = [LevelErrors(1e-9 * 4.0**n, 1e-7 * 9.0**n) for n in range(6)]
    wanted = choosing.blur_for_levels(*mesh_and_levels(*errors))
    chosen = choosing.allowed_levels(np.linspace(0.0, 20.0, 200), wanted)
    assert (np.diff(chosen) >= 0.0).all()
    assert chosen[-1] == 6.0


def test_without_levels_everything_is_drawn_in_full_detail():
    assert (choosing.allowed_levels(np.array([0.0, 7.0]), np.zeros(0)) == 0.0).all()
