"""Areas of triangles over the lens, and surfaces that its middle sees from the edge."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens, projected_areas
from addon.snapshot.camera import BokehSettings
from tests.gpu.conftest import triangles_snapshot

# A card in the plane of the axis, between 6 and 10 m; one that faces the camera.
CARD = np.array([[0.0, -0.4, -6.0], [0.0, 0.4, -6.0], [0.0, 0.4, -10.0]])
FACING = np.array([[-0.4, -0.4, -8.0], [0.4, -0.4, -8.0], [0.4, 0.4, -8.0]])


@pytest.mark.parametrize("orthographic", [False, True])
def test_the_mean_is_that_of_the_areas_from_places_all_over_the_lens(orthographic):
    rng = np.random.default_rng(2)
    corners = rng.normal(size=(12, 3, 3)) * [0.3, 0.3, 0.1] - [0.0, 0.0, 2.0]
    focus, extent = 1.3, np.array([0.5, 0.3])
    middle, mean = projected_areas(corners, focus, extent, orthographic)
    places = rng.uniform(-1.0, 1.0, (50_000, 2))
    places = places[(places**2).sum(axis=1) < 1.0] * extent
    depth = -corners[..., 2]
    # Methods 1: displaced by -R(d) v, and projected.
    moved = corners[:, None, :, :2] - places[:, None] * (1.0 - depth / focus)[:, None, :, None]
    seen = moved if orthographic else moved / depth[:, None, :, None]
    u, w = (seen[..., i, :] - seen[..., 0, :] for i in (1, 2))
    areas = 0.5 * np.abs(u[..., 0] * w[..., 1] - u[..., 1] * w[..., 0])
    # So many places have an error of two tenths of a per cent.
    np.testing.assert_allclose(mean, areas.mean(axis=1), rtol=8e-3)
    # Some of the planes cut the lens, some do not.
    assert (mean > 1.01 * middle).any() and np.isclose(mean, middle, rtol=1e-12).any()


def test_a_plane_through_the_middle_of_the_lens_is_seen_by_the_rest():
    for orthographic in (False, True):
        middle, mean = projected_areas(CARD, 3.0, (0.1, 0.1), orthographic)
        assert middle == 0.0 and mean > 0.0


def _plan(corners, extent=0.1):
    colors = [(5.0, 5.0, 5.0)] * len(corners)
    made = triangles_snapshot(corners, colors, 96, 64, ThinLens(extent, 3.0, Iris()))
    camera = replace(made.camera, bokeh=BokehSettings())
    sampling = replace(made.sampling, method="ADAPTIVE")
    return plan_frame(replace(made, camera=camera, sampling=sampling))


def test_lens_samples_keep_the_light_of_what_the_middle_sees_from_the_edge():
    bokeh = _plan([CARD, FACING]).bokeh
    assert bokeh.unsplit == {(0, 0)}
    assert bokeh.shining == {(1, 0)}


def test_surfaces_that_the_whole_lens_sees_from_one_side_are_splatted():
    # Its plane passes the axis at 0.2 m: a lens of 0.1 m sees its front, one of 1 m both sides.
    turned = CARD + [0.2, 0.0, 0.0]
    assert _plan([turned]).bokeh.shining == {(0, 0)}
    wide = _plan([turned, FACING], 1.0).bokeh
    assert wide.unsplit == {(0, 0)} and wide.shining == {(1, 0)}
