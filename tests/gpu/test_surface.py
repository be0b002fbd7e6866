"""A lens sample on the GPU sees what the software rasteriser sees."""

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from benchmarks.reference.rasterize import rasterize

from .conftest import (
    LENS,
    WORLD_COLOR,
    make_renderer,
    render_snapshot,
    some_triangles,
    triangles_snapshot,
)

pytestmark = pytest.mark.usefixtures("gpu_context")

# Rasterisers move vertices to a grid of 1/256 pixel; two vertices' worth of it, in both axes.
SNAP_PX = 0.02


def expected_color(sight, colors):
    picture = np.empty((*sight.triangle.shape, 4))
    picture[...] = (*WORLD_COLOR, 1.0)
    hit = sight.triangle >= 0
    picture[hit, :3] = colors[sight.triangle[hit]]
    return picture


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("index", [0, 1, 2, 3])
def test_one_lens_sample_equals_the_rasteriser(index, parallel):
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(corners, colors, lens=LENS, parallel=parallel)
    plan = plan_frame(snapshot)
    sight = rasterize(corners, plan, plan.lens_positions[index], plan.jitter[index])
    renderer = make_renderer(snapshot)
    renderer.advance(index)
    before = renderer.read_image() * index
    renderer.advance(1)
    sample = renderer.read_image() * (index + 1) - before
    renderer.release()
    sure = sight.margin > SNAP_PX
    assert sure.mean() > 0.9
    # Sums of up to four float32 values of at most 1, subtracted.
    assert np.abs(sample - expected_color(sight, colors))[sure].max() < 1e-6


def test_the_lens_displaces_nothing_at_the_focus_distance():
    corners = np.array([[[-0.5, -0.4, -3.0], [0.5, -0.4, -3.0], [0.0, 0.6, -3.0]]])
    snapshot = triangles_snapshot(corners, [(1.0, 1.0, 1.0)], lens=LENS, samples=16)
    blurred = render_snapshot(snapshot)["Combined"]
    sharp = render_snapshot(triangles_snapshot(corners, [(1.0, 1.0, 1.0)], lens=None, samples=16))[
        "Combined"
    ]
    # Only the rounding of the displaced vertices to the rasteriser's grid differs.
    assert np.abs(blurred - sharp).mean() < 1e-3


def test_a_transparent_film_leaves_the_world_out():
    corners, colors = some_triangles()
    picture = render_snapshot(
        triangles_snapshot(corners, colors, lens=LENS, samples=32, transparent=True)
    )["Combined"]
    assert (picture[picture[..., 3] == 0.0] == 0.0).all()
    assert picture[..., 3].min() == 0.0
    assert picture[..., 3].max() == 1.0
    partial = (picture[..., 3] > 0.1) & (picture[..., 3] < 0.9)
    assert partial.any()
    # Premultiplied: over the world's colour it is the picture with the world.
    with_world = render_snapshot(triangles_snapshot(corners, colors, lens=LENS, samples=32))
    over = picture[..., :3] + (1.0 - picture[..., 3:]) * np.array(WORLD_COLOR)
    # 32 additions in float32.
    assert np.abs(over - with_world["Combined"][..., :3]).max() < 5e-6
