"""What of a frame is splatted, and where highlights are searched."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.bokeh_search import deep_projection
from addon.engine.planning.plan import plan_frame
from addon.sampling.highlights import highlight_share
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings
from tests.gpu.conftest import triangles_snapshot

LENS = ThinLens(0.1, 3.0, Iris())
TRIANGLE = np.array([[-0.1, -0.1, -8.0], [0.1, -0.1, -8.0], [0.0, 0.1, -8.0]])


def snapshot(colors=((5.0, 5.0, 5.0),), corners=(TRIANGLE,), lens=LENS, method="ADAPTIVE", **own):
    made = triangles_snapshot(corners, colors, 96, 64, lens)
    return replace(
        made,
        camera=replace(made.camera, bokeh=BokehSettings(**own)),
        sampling=replace(made.sampling, method=method),
    )


def test_nothing_is_splatted_without_settings_without_lens_or_where_nothing_shines():
    assert plan_frame(snapshot()).bokeh is not None
    without = snapshot()
    without = replace(without, camera=replace(without.camera, bokeh=None))
    assert plan_frame(without).bokeh is None
    assert plan_frame(snapshot(lens=None)).bokeh is None
    assert plan_frame(snapshot(colors=((0.9, 0.9, 0.9),))).bokeh is None
    assert plan_frame(snapshot(threshold=6.0)).bokeh is None


def test_the_reference_method_splats_only_when_asked():
    made = snapshot(method="REFERENCE")
    assert plan_frame(made).bokeh is None
    made = replace(made, sampling=replace(made.sampling, reference_bokeh=True))
    assert plan_frame(made).bokeh is not None


def test_the_raster_reaches_as_far_beyond_the_frame_as_the_largest_blur():
    plan = plan_frame(snapshot(overscan=1.0))
    bokeh = plan.bokeh
    radius = plan.coc_scale * (8.0 - 3.0) / (8.0 * 3.0)
    assert bokeh.margin[0] == bokeh.margin[1] == int(np.ceil(radius)) + 2
    assert (bokeh.width, bokeh.height) == (96 + 2 * bokeh.margin[0], 64 + 2 * bokeh.margin[1])
    narrow = plan_frame(snapshot(overscan=0.02)).bokeh
    assert narrow.margin == (4, 4)


def test_a_pixel_of_the_raster_is_one_of_the_frame():
    plan = plan_frame(snapshot())
    bokeh = plan.bokeh
    point = np.array([0.7, -0.4, -6.0, 1.0])
    frame, raster = plan.projection @ point, bokeh.projection @ point
    in_frame = (frame[:2] / frame[3] + 1) / 2 * (plan.width, plan.height)
    in_raster = (raster[:2] / raster[3] + 1) / 2 * (bokeh.width, bokeh.height)
    assert in_raster - in_frame == pytest.approx(bokeh.margin)


def test_only_bright_surfaces_are_searched():
    dark = TRIANGLE * [1, 1, 0.5]
    bokeh = plan_frame(snapshot(((0.5, 0.5, 0.5), (5.0, 5.0, 5.0)), (dark, TRIANGLE))).bokeh
    assert bokeh.shining == {(1, 0)}


def test_small_triangles_are_searched_more_finely():
    coarse = plan_frame(snapshot(corners=(TRIANGLE * [9, 9, 1],))).bokeh
    fine = plan_frame(snapshot(corners=(TRIANGLE * [0.2, 0.2, 1],))).bokeh
    assert coarse.subpixels < 4 < fine.subpixels


def test_the_share_of_the_world_is_that_of_its_circle_of_confusion():
    made = snapshot()
    content = replace(made.content, world=replace(made.content.world, image=5))
    plan = plan_frame(replace(made, content=content))
    assert plan.bokeh.world
    assert plan.bokeh.world_share == highlight_share(plan.empty_coc, plan.bokeh.least_coc)


def test_lone_lamps_are_searched_where_they_are():
    bokeh = plan_frame(snapshot(corners=(TRIANGLE * [0.2, 0.2, 1],))).bokeh
    x, y, width, height = bokeh.part
    assert min(x, y) >= 0 and x + width <= bokeh.width and y + height <= bokeh.height
    assert 0 < width * height < 0.1 * bokeh.width * bokeh.height
    # 45 sub-pixels across, and never more than the budget.
    assert width * bokeh.subpixels >= 45
    assert width * height * bokeh.subpixels**2 <= 1 << 21


@pytest.mark.parametrize("parallel", [False, True])
def test_depths_of_the_search_enclose_highlights_and_what_hides_them(parallel):
    corners = (TRIANGLE, TRIANGLE - [0.0, 0.0, 4.0])
    made = triangles_snapshot(corners, ((5.0,) * 3,) * 2, 96, 64, LENS, parallel=parallel)
    plan = plan_frame(made)
    # The camera's own planes; the frame's are nearer to what is in view.
    wide = made.camera.projection
    deep = deep_projection(made.content, np.arange(2), plan, wide)
    np.testing.assert_array_equal(deep[[0, 1, 3]], wide[[0, 1, 3]])
    # Here the circle of confusion differs by 1 px from that at 8 m.
    move = 1.0 / plan.coc_scale
    hider = 8.0 - move * plan.focus_distance if parallel else 1.0 / (1.0 / 8.0 + move)
    for depth in (hider, 8.0, 12.0):
        clip = deep @ [0.0, 0.0, -depth, 1.0]
        assert -1.0 < clip[2] / clip[3] < 1.0
    before, after = (
        np.ptp([(p @ [0, 0, -d, 1])[2] / (p @ [0, 0, -d, 1])[3] for d in (8.0, 8.01)])
        for p in (wide, deep)
    )
    assert after > 10.0 * before
