"""Thin slices of one surface in a pixel are gathered; what is transparent stays as it is."""

import numpy as np
import pytest

from addon.layers.sinking import sink

ROWS, COLUMNS = 16, 8
# Vergence of the first row, and by how much it falls from row to row.
NEAREST, FALL = 1.0, 0.05


def steps(depth):
    with np.errstate(divide="ignore"):
        return -1.0 / depth


def floor(layers, overlap=0.1, thinned=None):
    """Colours and depths of a floor in so many layers, of equal steps of vergence.

    Each has the share of a row that lies between its bounds, and a little more of the next; of
    `thinned`, a layer, nothing was left where it has less than whole rows.
    """
    bounds = NEAREST - np.arange(layers + 1) * FALL * ROWS / layers
    colors, depths = [], []
    rows = NEAREST - np.arange(ROWS) * FALL
    for number, (near, far) in enumerate(zip(bounds[:-1], bounds[1:], strict=True)):
        far = far - overlap * (near - far)
        share = (np.minimum(rows, near) - np.maximum(rows - FALL, far)) / FALL
        share = np.clip(share, 0.0, 1.0)
        share[share < 1e-6] = 0.0
        share[share > 1.0 - 1e-6] = 1.0
        if number == thinned:
            share[share < 1.0] = 0.0
        alpha = np.repeat(share[:, None], COLUMNS, axis=1).astype(np.float32)
        color = np.stack([0.5 * alpha] * 3 + [alpha], axis=-1)
        middle = 1.0 / (rows - 0.5 * FALL)
        depth = np.where(alpha > 0.0, middle[:, None], np.inf).astype(np.float32)
        colors.append(color)
        depths.append(depth)
    return colors, depths


def laid_over(colors):
    total = np.zeros_like(colors[0])
    for color in reversed(colors):
        total = color + (1.0 - color[..., 3:]) * total
    return total


@pytest.mark.parametrize("layers", [13, 20, 31, 47])
def test_a_floor_of_slices_thinner_than_rows_is_whole(layers):
    colors, depths = floor(layers)
    # Part beside part taken for part behind part lets through what is behind the floor.
    assert laid_over(colors)[3:-3, 3:-3, 3].min() < 0.9
    found = sink(colors, depths, steps)
    inner = laid_over(found.colors)[3:-3, 3:-3]
    assert inner[..., 3] == pytest.approx(np.ones(inner.shape[:2]), abs=1e-5)
    assert inner[..., :3] == pytest.approx(np.full((*inner.shape[:2], 3), 0.5), abs=1e-5)
    for color, depth, own in zip(found.colors, found.depths, depths, strict=True):
        # Still a depth wherever something is, between those that were there.
        assert (np.isfinite(depth) == (color[..., 3] > 0.0)).all()
        assert depth[np.isfinite(depth)].max(initial=0.0) <= own[np.isfinite(own)].max() + 1e-3


def test_what_has_faded_of_a_layer_is_made_up_for():
    colors, depths = floor(31, thinned=15)
    found = sink(colors, depths, steps)
    assert laid_over(found.colors)[3:-3, 3:-3, 3].min() > 1.0 - 1e-5


def test_layers_with_whole_rows_stay():
    colors, depths = floor(4, overlap=0.0)
    found = sink(colors, depths, steps)
    assert not found.any
    assert all(a is b for a, b in zip(found.colors, colors, strict=True))


def test_smoke_stays_transparent():
    shares = np.full((ROWS, COLUMNS), 0.4, np.float32)
    colors = [np.stack([0.5 * shares] * 3 + [shares], axis=-1) for _ in range(4)]
    depths = [np.full((ROWS, COLUMNS), 2.0 + n, np.float32) for n in range(4)]
    assert not sink(colors, depths, steps).any


def test_strands_before_a_wall_stay_thin():
    colors, depths = [], []
    for number, column in enumerate((3, 3, 4)):
        share = np.zeros((ROWS, COLUMNS), np.float32)
        share[:, column] = 0.6
        colors.append(np.stack([share] * 4, axis=-1))
        depths.append(np.where(share > 0.0, 2.0 + number, np.inf).astype(np.float32))
    colors.append(np.ones((ROWS, COLUMNS, 4), np.float32))
    depths.append(np.full((ROWS, COLUMNS), 9.0, np.float32))
    assert not sink(colors, depths, steps).any


def test_the_edge_of_a_leaf_between_others_does_not_become_a_leaf():
    """Leaves before, at and behind a place lie as a floor's rows do by chance."""
    rows = np.arange(ROWS)[:, None] * np.ones((1, COLUMNS), int)
    shares = [np.where(found, 0.6, 0.0) for found in (rows < 8, rows == 8, rows > 8)]
    shares[1][8, 4] = 0.1
    depth = 1.0 / (NEAREST - rows * FALL)
    colors = [np.stack([share] * 4, axis=-1).astype(np.float32) for share in shares]
    depths = [np.where(share > 0.0, depth, np.inf).astype(np.float32) for share in shares]
    assert laid_over(sink(colors, depths, steps).colors)[8, 4] == pytest.approx(np.full(4, 0.1))
