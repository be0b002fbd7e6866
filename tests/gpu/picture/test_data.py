"""The data passes on the GPU hold what the software rasteriser finds in the middle of a pixel."""

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.sampling.thin_lens import ThinLens
from addon.sampling.thin_lens import coc_radius_px as thin_lens_coc
from benchmarks.reference.mattes import coc_radius_px
from benchmarks.reference.rasterize import rasterize

from ..conftest import LENS, render_snapshot, some_triangles, triangles_snapshot
from ..test_surface import SNAP_PX

pytestmark = pytest.mark.usefixtures("gpu_context")

PASSES = ("Combined", "Depth", "Position", "Normal", "CoC")


@pytest.fixture(scope="module", params=[False, True], ids=["perspective", "parallel"])
def frame(request, gpu_context):
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(
        corners, colors, lens=LENS, samples=2, passes=PASSES, parallel=request.param
    )
    plan = plan_frame(snapshot)
    sight = rasterize(corners, plan)
    return render_snapshot(snapshot), plan, sight, corners, snapshot


def test_depth_and_position_are_those_of_the_middle_of_the_pixel(frame):
    pictures, _, sight, _, _ = frame
    sure = (sight.margin > SNAP_PX) & (sight.triangle >= 0)
    # 1/256 pixel of the grid on surfaces that are tilted by up to a few m per pixel width.
    assert np.median(np.abs(pictures["Depth"][..., 0] - sight.depth)[sure]) < 1e-3
    assert np.abs(pictures["Depth"][..., 0] - sight.depth)[sure].max() < 0.05
    assert np.abs(pictures["Position"] - sight.position)[sure].max() < 0.05


def test_normals_are_those_of_the_triangles_turned_to_the_camera(frame):
    pictures, plan, sight, corners, _ = frame
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    sure = (sight.margin > 1.5) & (sight.triangle >= 0)
    expected = normals[sight.triangle[sure]]
    towards = np.array([0.0, 0.0, 1.0]) if plan.orthographic else -sight.position[sure]
    expected *= np.sign((expected * towards).sum(axis=-1, keepdims=True))
    # Derivatives of float32 positions over a pixel of about 0.05 m.
    assert np.abs(pictures["Normal"][sure] - expected).max() < 1e-3


def test_coc_follows_from_depth(frame):
    pictures, plan, sight, _, _ = frame
    hit = pictures["Depth"][..., 0] < 1e9
    depth = pictures["Depth"][..., 0].astype(np.float64)
    expected = coc_radius_px(depth, plan.focus_distance, plan.coc_scale, plan.orthographic)
    # float32
    assert np.abs(pictures["CoC"][..., 0] - expected)[hit].max() < 1e-4
    assert (pictures["CoC"][~hit] == np.float32(plan.empty_coc)).all()
    near = hit & (depth < plan.focus_distance)
    assert (pictures["CoC"][near] <= 0.0).all()


def test_coc_of_a_perspective_camera_is_that_of_the_thin_lens():
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=1, passes=PASSES)
    pictures = render_snapshot(snapshot)
    depth = pictures["Depth"].astype(np.float64)
    focal_px = snapshot.camera.projection[1, 1] * snapshot.film.height / 2
    expected = thin_lens_coc(depth, ThinLens(LENS.aperture_radius, 3.0), focal_px)
    hit = depth < 1e9
    assert np.abs(pictures["CoC"] - expected)[hit].max() < 1e-4


def test_coc_is_the_extent_of_a_blurred_point():
    depth = 6.0
    # A triangle much smaller than a pixel in the middle of the picture.
    corners = np.array([[[-0.02, -0.02, -depth], [0.02, -0.02, -depth], [0.0, 0.02, -depth]]])
    snapshot = triangles_snapshot(
        corners, [(1.0, 1.0, 1.0)], lens=ThinLens(0.3, 3.0), samples=512, passes=PASSES
    )
    plan = plan_frame(snapshot)
    picture = render_snapshot(snapshot)["Combined"]
    lit = np.abs(picture[..., 0] - 0.125) > 0
    rows = np.flatnonzero(lit.any(axis=1))
    radius = coc_radius_px(depth, plan.focus_distance, plan.coc_scale)
    # Half of the lit rows, good to a pixel on either side.
    assert (rows[-1] - rows[0] + 1) / 2 == pytest.approx(radius, abs=1.0)


def test_a_data_pass_does_not_depend_on_the_lens_or_the_samples(frame):
    pictures, plan, _, _, snapshot = frame
    corners, colors = some_triangles()
    other = triangles_snapshot(
        corners, colors, lens=None, samples=7, passes=PASSES, parallel=plan.orthographic
    )
    others = render_snapshot(other)
    for name in ("Depth", "Position", "Normal"):
        assert pictures[name].tobytes() == others[name].tobytes()
