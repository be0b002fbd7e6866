"""How much light small surfaces have in the picture of a real lens, for their discs."""

import numpy as np

from .field_grid import FieldGrid
from .landing import spread_places

# Places of the iris whose mean is the light: rims cut the picture anew at each depth. What every
# one has more, over that of all.
_PLACES, _LEAST_LIGHT = 256, 0.01
# Powers of the vergence; nodes of the movements over those of the light along an axis.
POWERS, _COARSER = 8, 2


def enlarged(tables):
    """Find how much more light small surfaces have in the picture than a pinhole shows of them.

    With an even exposure: a sample counts as much as it has of the light where it lands, and shows
    surfaces larger or smaller.

    Parameters
    ----------
    tables : SampleTables

    Returns
    -------
    ndarray of float32, shape (rows, 2 columns, 4)
        Mean over the iris at nodes from the first to the last of the movements: coefficients of the
        powers of V over the largest vergence, 0 to 3, then 4 to 7 to the right of all those.
    """
    grid = tables.moves_grid
    places = spread_places(_PLACES) / (tables.ratio, 1.0) * tables.aperture_radius
    moves = tables.moves(places)
    step = (grid.high - grid.low) / (grid.columns - 1, grid.rows - 1)
    slopes = (np.gradient(moves, size, axis=axis) for size, axis in ((step[1], 1), (step[0], 2)))
    columns, rows = (-(-(count - 1) // _COARSER) + 1 for count in (grid.columns, grid.rows))
    coarse = FieldGrid(grid.low, grid.high, columns, rows)
    index, weights = (part[:, None] for part in grid.taps(coarse.nodes))
    every = [
        np.einsum("pat,npatkc->npkc", weights, each.reshape(_PLACES, -1, 4, 2)[:, index])
        for each in (moves, *slopes)
    ]
    # Of all samples at the nodes of the light, over their mean there.
    light = tables.light(places, np.sqrt(np.pi / _PLACES)).reshape(_PLACES, -1)
    light += _LEAST_LIGHT * light.mean()
    light /= light.mean(axis=0)
    at = 0.5 - 0.5 * np.cos((np.arange(POWERS) + 0.5) / POWERS * np.pi)
    cubic = at[:, None] ** np.arange(4)
    thin = (tables.focus_vergence - at * tables.largest_vergence)[:, None, None]
    found = np.zeros((POWERS, rows * columns))
    for place, moved, up, right, own in zip(places, *every, light, strict=True):
        moved, up, right = (np.einsum("vk,pkc->vpc", cubic, each) for each in (moved, up, right))
        larger = (1.0 + right[..., 0]) * (1.0 + up[..., 1]) - right[..., 1] * up[..., 0]
        node, share = tables.light_grid.taps(coarse.nodes + moved + place * thin)
        found += (own[node] * share).sum(axis=-1) * np.abs(larger)
    found = np.linalg.inv(at[:, None] ** np.arange(POWERS)) @ (found / _PLACES)
    found = found.T.reshape(rows, columns, POWERS // 4, 4)
    return found.swapaxes(1, 2).reshape(rows, -1, 4).astype(np.float32)
