"""Which highlights a frame merges."""

from addon.engine.bokeh_clusters import POINT_BUDGET, similarity_of
from addon.scene.snapshot import BokehSettings


def test_points_are_left_alone_up_to_a_budget():
    assert similarity_of(BokehSettings(), POINT_BUDGET) is None


def test_beyond_the_budget_points_spread_over_a_sixteenth_of_their_discs_at_most():
    similarity = similarity_of(BokehSettings(), POINT_BUDGET + 1)
    assert similarity.extent <= 1.0 / 16.0
    assert similarity.cell * 2**similarity.levels <= 1.0 / 16.0


def test_clusters_follow_the_settings():
    one = similarity_of(BokehSettings(model="CLUSTERED", cluster_levels=3), 10)
    two = similarity_of(BokehSettings(model="CLUSTERED", similarity=2.0, global_merge=True), 10)
    assert one.levels == 3
    assert one.pairs == 0
    assert two.pairs > 0
    assert two.cell == 2.0 * one.cell
    assert two.harm == 4.0 * one.harm
