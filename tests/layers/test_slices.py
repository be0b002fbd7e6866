"""Slices: where they are cut, where they fade, and depths of what is covered in part."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.layers.slices import NOTHING, Slice, filled_depth, plan_slices

_depths = st.floats(0.01, 1e6)


@given(
    count=st.integers(1, 16),
    depths=st.tuples(_depths, _depths),
    clip_start=st.floats(0.001, 10.0),
    reach=st.floats(1.01, 1e5),
    orthographic=st.booleans(),
)
def test_slices_cover_all_that_the_camera_sees(count, depths, clip_start, reach, orthographic):
    clip_end = clip_start * reach
    slices = plan_slices(count, min(depths), max(depths), clip_start, clip_end, orthographic)
    assert len(slices) in {1, count}
    assert (slices[0].near, slices[-1].far) == (0.0, math.inf)
    assert (slices[0].clip_start, slices[-1].clip_end) == (clip_start, clip_end)
    for one, following in zip(slices, slices[1:], strict=False):
        assert one.far == following.near == following.clip_start
        assert one.clip_start < one.far < one.clip_end <= clip_end
        # The overlap ends in the next layer.
        assert one.clip_end < following.clip_end or one.clip_end == clip_end


def test_what_is_flat_or_empty_is_one_slice():
    assert len(plan_slices(8, 5.0, 5.0, 0.1, 100.0)) == 1
    assert len(plan_slices(8, math.inf, math.inf, 0.1, 100.0)) == 1
    # Farther than the camera sees, or before it: as if there were nothing.
    assert len(plan_slices(8, 200.0, 300.0, 0.1, 100.0)) == 1


@pytest.mark.parametrize("orthographic", [False, True])
def test_a_layer_is_whole_to_its_cut_and_gone_where_the_slice_ends(orthographic):
    slice_ = plan_slices(4, 2.0, 20.0, 0.1, 100.0, orthographic)[1]
    depths = np.linspace(slice_.near, slice_.clip_end, 500)
    weights = slice_.weights(depths)
    assert (weights[depths <= slice_.far] == 1.0).all()
    assert weights[-1] == 0.0 and (np.diff(weights) <= 0.0).all()
    assert ((weights > 0.0) & (weights < 1.0)).sum() > 0
    assert slice_.weights(np.array([np.inf]))[0] == 1.0
    assert (Slice(2.0, math.inf, 2.0, 9.0).weights(depths) == 1.0).all()


def test_depths_of_partly_covered_pixels_come_from_their_neighbours():
    depth = np.full((5, 7), 1e10, np.float32)
    coverage = np.zeros((5, 7))
    depth[2, 1:3] = (4.0, 3.0)
    coverage[2, 1:5] = 0.5
    coverage[0, 6] = 0.1
    depth[4, 0] = 9.0
    assert depth.max() >= NOTHING
    found, guessed = filled_depth(depth, coverage, 7.0)
    assert found[2, 1:5].tolist() == [4.0, 3.0, 3.0, 3.0]
    assert (found[0, 6], guessed) == (7.0, 1)
    # What covers nothing has no depth, whatever the renderer says.
    assert np.isinf(found[4, 0])
