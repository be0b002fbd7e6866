"""Tiles of the raster that highlights are searched in."""

import numpy as np
import pytest

from addon.engine.bokeh.search_tiles import tiles_of


@pytest.mark.parametrize(
    ("part", "subpixels"),
    [((0, 0, 96, 64), 4), ((7, 3, 2000, 1200), 4), ((1, 0, 5, 3), 32), ((0, 9, 9000, 2), 8)],
)
def test_tiles_cover_the_part_once(part, subpixels):
    tiles = tiles_of(part, subpixels)
    x, y, width, height = part
    covered = np.zeros((y + height, x + width), int)
    for left, below, w, h in tiles:
        assert w <= tiles[0][2] and h <= tiles[0][3] and min(w, h) > 0
        assert w * h * subpixels**2 <= 1 << 22 and max(w, h) * subpixels <= 8192
        covered[below : below + h, left : left + w] += 1
    assert (covered[y:, x:] == 1).all() and covered.sum() == width * height


def test_a_part_without_area_has_no_tiles():
    assert tiles_of((0, 0, 0, 0), 4) == []
