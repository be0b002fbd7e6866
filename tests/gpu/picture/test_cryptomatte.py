"""Cryptomatte tables on the GPU count as the numpy twin counts, with room and without."""

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from benchmarks.reference.mattes import RankTable
from benchmarks.reference.rasterize import rasterize

from ..conftest import LENS, render_snapshot, some_triangles, triangles_snapshot
from ..test_surface import SNAP_PX

pytestmark = pytest.mark.usefixtures("gpu_context")

SAMPLES = 12


def _expected(corners, plan, slots, first_id):
    table = RankTable((plan.height, plan.width), slots)
    margin = np.full((plan.height, plan.width), np.inf)
    for index in range(SAMPLES):
        sight = rasterize(corners, plan, plan.lens_positions[index], plan.jitter[index])
        ids = np.where(sight.triangle >= 0, sight.triangle + first_id, 0)
        table.count(ids.astype(np.float32))
        margin = np.minimum(margin, sight.margin)
    return *table.ranks(SAMPLES), margin > SNAP_PX


@pytest.mark.parametrize("passes", [1, 3])
def test_ranks_equal_the_twin(passes):
    corners, colors = some_triangles(count=9)
    names = [f"{kind}{i:02d}" for kind in ("CryptoObject", "CryptoMaterial") for i in range(passes)]
    snapshot = triangles_snapshot(
        corners, colors, lens=LENS, samples=SAMPLES, passes=("Combined", *names)
    )
    plan = plan_frame(snapshot)
    pictures = render_snapshot(snapshot)
    for kind, first_id in (("CryptoObject", 1), ("CryptoMaterial", 100)):
        # Two slots more than ranks.
        ids, coverage, sure = _expected(corners, plan, 2 * passes + 2, first_id)
        assert sure.mean() > 0.3
        for rank in range(2 * passes):
            picture = pictures[f"{kind}{rank // 2:02d}"][..., 2 * (rank % 2) :]
            assert (picture[..., 0] == ids[..., rank])[sure].all()
            # One rounding of a count times 1/12.
            assert np.abs(picture[..., 1] - coverage[..., rank])[sure].max() < 1e-6


def test_a_full_table_keeps_the_total_coverage():
    corners, colors = some_triangles(seed=5, count=16)
    table = RankTable((1,), 4)
    for identifier in [1, 2, 3, 4, 5, 5, 5, 6, 1, 1, 1]:
        table.count(np.array([identifier], np.float32))
    ids, coverage = table.ranks(11)
    assert coverage.sum() == pytest.approx(1.0)
    assert {1.0, 5.0} <= set(ids[0].tolist())


def test_only_one_kind_may_be_asked_for():
    corners, colors = some_triangles()
    both = render_snapshot(
        triangles_snapshot(
            corners,
            colors,
            lens=LENS,
            samples=SAMPLES,
            passes=("Combined", "CryptoObject00", "CryptoMaterial00"),
        )
    )
    one = render_snapshot(
        triangles_snapshot(
            corners, colors, lens=LENS, samples=SAMPLES, passes=("Combined", "CryptoMaterial00")
        )
    )
    assert one["CryptoMaterial00"].tobytes() == both["CryptoMaterial00"].tobytes()


def test_mattes_do_not_change_combined():
    corners, colors = some_triangles()
    plain = render_snapshot(triangles_snapshot(corners, colors, lens=LENS, samples=SAMPLES))
    with_mattes = render_snapshot(
        triangles_snapshot(
            corners,
            colors,
            lens=LENS,
            samples=SAMPLES,
            passes=("Combined", "Focus Matte", "CryptoObject00"),
        )
    )
    assert plain["Combined"].tobytes() == with_mattes["Combined"].tobytes()
