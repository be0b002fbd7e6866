"""Light of a beam that lands on the texels of a tile, and far beyond them."""

import numpy as np
import pytest

from addon.lens_bokeh.look import tile_drawing

SIZE = 8


@pytest.mark.parametrize("x", [-1e3, 3.0, 1e3])
@pytest.mark.parametrize("y", [-1e3, 3.0, 1e3])
@pytest.mark.parametrize("wide", [0.5, 3.0])
def test_what_lands_beyond_a_corner_falls_outside(x, y, wide):
    # A caustic throws rays of the rim that far.
    places = (np.array([v], np.float32) for v in (x, y, wide, wide))
    picture = tile_drawing._deposited(*places, [np.ones(1, np.float32)], SIZE)
    inside = 0.0 < x < SIZE and 0.0 < y < SIZE
    assert picture.shape == (1, SIZE, SIZE)
    assert picture.sum() == pytest.approx(float(inside))
