"""The picture is the mean of its samples, and the focus matte that of its shares."""

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from benchmarks.reference.mattes import coc_radius_px, focus_share
from benchmarks.reference.rasterize import rasterize

from ..conftest import LENS, render_snapshot, some_triangles, triangles_snapshot
from ..test_surface import SNAP_PX, expected_color

pytestmark = pytest.mark.usefixtures("gpu_context")

SAMPLES = 8


@pytest.fixture(scope="module")
def frame(gpu_context):
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(
        corners, colors, lens=LENS, samples=SAMPLES, passes=("Combined", "Focus Matte")
    )
    plan = plan_frame(snapshot)
    sights = [
        rasterize(corners, plan, plan.lens_positions[i], plan.jitter[i]) for i in range(SAMPLES)
    ]
    sure = np.minimum.reduce([sight.margin for sight in sights]) > SNAP_PX
    assert sure.mean() > 0.5
    return render_snapshot(snapshot), plan, sights, colors, sure


def test_combined_is_the_mean_of_the_samples(frame):
    pictures, _, sights, colors, sure = frame
    expected = np.mean([expected_color(sight, colors) for sight in sights], axis=0)
    # A few additions in float32.
    assert np.abs(pictures["Combined"] - expected)[sure].max() < 1e-6


def test_focus_matte_is_the_mean_share_of_sharpness(frame):
    pictures, plan, sights, _, sure = frame
    shares = []
    for sight in sights:
        hit = sight.triangle >= 0
        depth = np.where(hit, sight.depth, 1.0)
        coc = coc_radius_px(depth, plan.focus_distance, plan.coc_scale)
        shares.append(focus_share(np.where(hit, coc, plan.empty_coc), plan.sharp_radius))
    matte = pictures["Focus Matte"][..., 0]
    # The share changes fastest near the focus; vertices snapped to the grid move the depth there.
    assert np.abs(matte - np.mean(shares, axis=0))[sure].max() < 2e-3
    assert matte.min() >= 0.0
    assert matte.max() <= 1.0 + 1e-6


def test_everything_is_in_focus_without_a_lens():
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(
        corners, colors, lens=None, samples=2, passes=("Combined", "Focus Matte", "CoC")
    )
    pictures = render_snapshot(snapshot)
    assert (pictures["Focus Matte"] == 1.0).all()
    assert (pictures["CoC"] == 0.0).all()


def test_the_same_frame_twice_is_the_same_bits():
    corners, colors = some_triangles()
    passes = ("Combined", "Depth", "CoC", "Focus Matte", "CryptoObject00", "CryptoMaterial00")
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=20, passes=passes)
    first, second = render_snapshot(snapshot), render_snapshot(snapshot)
    for name in passes:
        assert first[name].tobytes() == second[name].tobytes(), name


def test_chunks_of_samples_do_not_change_the_bits():
    from ..conftest import make_renderer

    corners, colors = some_triangles()
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=40)
    whole = render_snapshot(snapshot)["Combined"]
    renderer = make_renderer(snapshot)
    while not renderer.finished():
        renderer.advance(7)
    assert renderer.read_image().tobytes() == whole.tobytes()
    renderer.release()
