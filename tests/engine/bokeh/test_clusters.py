"""Which highlights a frame merges."""

from addon.engine.bokeh.clusters import POINT_BUDGET, similarity_of
from addon.snapshot.camera import BokehSettings


def test_points_are_left_alone_up_to_a_budget():
    assert similarity_of(BokehSettings(), POINT_BUDGET) is None
    assert similarity_of(BokehSettings(model="POINT"), 100 * POINT_BUDGET) is None


def test_beyond_the_budget_merging_sets_in_smoothly():
    harms = [similarity_of(BokehSettings(), POINT_BUDGET * n).harm for n in (2, 5, 10, 100, 1000)]
    assert similarity_of(BokehSettings(), POINT_BUDGET + 1).harm < 1e-6
    assert harms == sorted(harms)
    # A disc as bright as white, of 8 px radius, is blurred over 1.4 px at most.
    assert harms[-1] == harms[-2] <= 1.4**2 / 64.0


def test_clusters_follow_the_settings():
    one = similarity_of(BokehSettings(model="CLUSTERED", cluster_levels=3), 10)
    two = similarity_of(BokehSettings(model="CLUSTERED", similarity=2.0, global_merge=True), 10)
    assert one.levels == 3
    assert one.pairs == 0
    assert two.pairs > 0
    assert two.cell == 2.0 * one.cell
    assert two.harm == 4.0 * one.harm


def test_the_more_highlights_there_are_the_less_harm_a_merge_may_do():
    few, some, many = (
        similarity_of(BokehSettings(model="CLUSTERED"), count).harm for count in (10, 10000, 40000)
    )
    assert few > some > many
    assert many == 0.25 * some
