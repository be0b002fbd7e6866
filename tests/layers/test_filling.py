"""Holes of an opaque picture are filled from around."""

import numpy as np

from addon.layers.filling import filled


def test_coverage_is_divided_out_and_holes_take_what_is_around_them():
    picture = np.zeros((7, 11, 4), np.float32)
    picture[:, :4] = np.array([0.2, 0.4, 0.6, 1.0]) * 0.5
    picture[:, 9:] = (1.0, 0.0, 0.0, 1.0)
    found = filled(picture)
    assert found.shape == picture.shape and (found[..., 3] == 1.0).all()
    assert np.abs(found[:, :4, :3] - (0.2, 0.4, 0.6)).max() < 1e-6
    assert (found[:, 9:] == picture[:, 9:]).all()
    # Between the two, and no darker than either.
    assert (found[..., 0] >= 0.2 - 1e-6).all() and (found[..., :3].sum(axis=-1) >= 1.0 - 1e-6).all()


def test_a_picture_without_anything_is_left():
    nothing = np.zeros((3, 5, 4), np.float32)
    assert filled(nothing).tobytes() == nothing.tobytes()
