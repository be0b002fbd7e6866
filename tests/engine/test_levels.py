"""Levels of detail: the mapping from blur to triangles, and who draws which level when."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import levels
from addon.engine.plan import plan_frame
from addon.sampling.thin_lens import ThinLens
from addon.scene.snapshot import Sampling

from .test_plan import snapshot

FOCUS = 4.0


def plan_for(lens=None, **sampling):
    frame = snapshot(lens or ThinLens(0.1, FOCUS))
    return plan_frame(replace(frame, sampling=Sampling("ADAPTIVE", 32, **sampling)))


def seen_box(depth, radius=0.2, length=0.0):
    as_rows = [np.array([value]) for value in (depth - length / 2, depth + length / 2, depth)]
    return levels.Extents(*as_rows, np.array([radius]))


def test_a_triangle_as_large_as_the_blur_is_level_zero_and_each_quarter_two_more():
    plan = plan_for()
    depth = 10.0
    blur = np.pi * levels.coc_radius(depth, plan) ** 2
    scale = plan.projection[1, 1] * plan.height / 2.0
    area = np.pi * (scale * 0.2 / depth) ** 2
    # As many triangles, seen from both sides, as circles of confusion fit into the object.
    triangles = np.array([area / blur / 0.5])
    bias = 0.0
    box = seen_box(depth)
    assert levels.choose_levels(box, triangles, plan, bias)[0] == pytest.approx(0.0, abs=1e-9)
    assert levels.choose_levels(box, 4 * triangles, plan, bias)[0] == pytest.approx(2.0)
    assert levels.choose_levels(box, 4 * triangles, plan, bias + 1.0)[0] == pytest.approx(1.0)


def test_what_is_partly_in_focus_keeps_full_detail():
    plan = plan_for()
    many = np.array([1e7])
    assert levels.choose_levels(seen_box(FOCUS + 1.0, length=2.5), many, plan)[0] == 0.0
    assert levels.choose_levels(seen_box(FOCUS + 1.0, length=1.0), many, plan)[0] > 0.0


def test_what_reaches_behind_the_camera_keeps_full_detail():
    assert levels.choose_levels(seen_box(0.5, length=1.5), np.array([1e7]), plan_for())[0] == 0.0


def test_a_pinhole_has_no_levels():
    plan = plan_for(ThinLens(0.0, FOCUS))
    assert levels.choose_levels(seen_box(10.0), np.array([1e7]), plan)[0] == 0.0


def test_triangles_of_the_blurred_area_cover_a_circle_of_confusion_in_the_picture():
    plan = plan_for()
    depth = np.array([FOCUS, 6.0, 10.0, 1.5, -2.0])
    world = np.diag([2.0, 2.0, 2.0, 1.0])
    area = levels.blurred_area(depth, world, plan, 0.0)
    # Twice as large in the world, seen at an average angle.
    scale = plan.projection[1, 1] * plan.height / 2.0
    seen = 0.5 * area * 4.0 * (scale / depth) ** 2
    circle = np.pi * levels.coc_radius(depth, plan) ** 2
    assert seen[1:4] == pytest.approx(circle[1:4])
    assert area[0] == area[4] == 0.0, "in focus, and behind the camera"
    assert levels.blurred_area(depth, world, plan, 1.0) == pytest.approx(area / 2.0)


def test_more_blur_never_means_more_detail():
    triangles = np.array([1e6])
    radii = (0.01, 0.02, 0.05, 0.1, 0.3)
    chosen = [
        levels.choose_levels(seen_box(9.0), triangles, plan_for(ThinLens(r, FOCUS)))[0]
        for r in radii
    ]
    assert chosen == sorted(chosen)
    assert chosen[-1] > chosen[0]


def test_the_first_share_of_the_samples_draws_the_finer_level():
    drawn = [levels.level_for_sample(np.array([2.3]), i, 10)[0] for i in range(10)]
    assert drawn == [2] * 7 + [3] * 3


def test_a_whole_level_is_drawn_by_all_samples():
    assert {int(levels.level_for_sample(np.array([3.0]), i, 16)[0]) for i in range(16)} == {3}


def test_both_levels_share_the_lens_evenly():
    plan = plan_for()
    chosen = np.array([levels.level_for_sample(np.array([1.5]), i, 32)[0] for i in range(32)])
    for level in (1, 2):
        center = plan.lens_positions[chosen == level].mean(axis=0)
        # The centre of 16 points of the sequence lies within a tenth of the radius.
        assert np.linalg.norm(center) < 0.1 * 0.1


def test_colours_that_vary_more_are_drawn_finer():
    allowed = [levels.color_allowance(contrast) for contrast in (0.0, 0.1, 0.25, 0.5, 1.0, 9.0)]
    assert allowed == sorted(allowed)
    assert allowed[0] == levels.LEAST_ALLOWANCE
    assert allowed[3] - allowed[2] == pytest.approx(2.0)
    assert allowed[-1] == allowed[-2]
