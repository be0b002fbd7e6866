"""Gathers what thin slices have of one surface in a pixel.

Where a surface goes away so steeply that a slice of it is narrower than a pixel (many layers, a
small picture, a table seen from its edge), several layers have a part of the pixel each. These
parts lie beside one another, but layers laid over each other take them for transparent surfaces
behind one another: a third of the light of a floor came from behind it. Here the farthest of the
layers gets the whole, and the others nothing.

What is transparent (smoke, hair, glass) looks different: there a layer goes on to all sides. Of a
surface that goes away, the nearer layer ends towards the far side, and the farther layer towards
the near one, and others go on there.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

# Coverage of a pixel that nothing is seen through: a sample's share may be lost in rounding.
WHOLE = 1.0 - 1e-3
# How far to the sides it is looked for where layers end, px: pixel filters reach as far.
SIDE = 2
# Layers before and behind among which a surface goes on at the sides. Anything from 4 to 20 is as
# good (floors, roofs, stairs, hills, fences and foliage in 12 and 24 layers).
_BESIDE = 12
# Coverage of a pixel that has more of the surface than of what is around it. As good: 0.3 to 0.8.
_MOST = 0.5
# Largest distance of a slope's middle from the mean of its sides, as a share of its rise. As good:
# 0.2 to 0.6; with 0.1 a sixth more pixels of those scenes are wrong.
_BENT = 0.3


@dataclass(frozen=True, eq=False)
class Sunk:
    """Layers with thin parts gathered.

    Parameters
    ----------
    colors : list of ndarray of shape (height, width, 4)
    depths : list of ndarray of shape (height, width)
    rises : list of ndarray of shape (height, width)
        float32: of pixels that were gathered, by how much the surface rises in twice `SIDE`
        pixels, in the measure of depth; 0 elsewhere.
    """

    colors: list
    depths: list
    rises: list

    @property
    def any(self):
        """Whether anything was gathered."""
        return any(rise.any() for rise in self.rises)


def sink(colors, depths, steps):
    """Gather the thin parts of surfaces in the farthest layer that has one.

    Parameters
    ----------
    colors : sequence of ndarray of shape (height, width, 4)
        Premultiplied, the foremost layer first, without the world.
    depths : sequence of ndarray of shape (height, width)
        In m; inf where nothing is.
    steps : callable
        From depths to a measure that planes are linear in over the picture.

    Returns
    -------
    Sunk
        Arrays of layers that nothing was changed in are those that were given.
    """
    held = depths
    colors, depths = list(colors), list(depths)
    covers = [color[..., 3] for color in colors]
    shape = covers[0].shape
    rises = [np.zeros(shape, np.float32) for _ in colors]
    weights = [cover.copy() for cover in covers]
    for near in range(len(colors) - 1):
        far = near + 1
        both = (covers[near] > 0.0) & (covers[near] < WHOLE)
        both &= (covers[far] > 0.0) & (covers[far] < WHOLE)
        if not both.any():
            continue
        rows, columns = np.nonzero(both)
        rise, inside = _slope(covers, held, steps, (near, far), rows, columns)
        found = rise > 0.0
        if not found.any():
            continue
        rows, columns, rise, inside = (each[found] for each in (rows, columns, rise, inside))
        at = rows, columns
        for number in (near, far):
            colors[number], depths[number] = colors[number].copy(), depths[number].copy()
        part = weights[near][at], covers[far][at]
        total = part[0] + part[1]
        # What was gathered before is no longer premultiplied by its share.
        own = colors[near][at]
        light = own / own[:, 3:] * part[0][:, None] + colors[far][at]
        alpha = np.where(inside, 1.0, np.minimum(total, 1.0))
        colors[far][at] = light / total[:, None] * alpha[:, None]
        depth = [1.0 / np.maximum(depths[number][at], 1e-9) for number in (near, far)]
        depths[far][at] = total / (part[0] * depth[0] + part[1] * depth[1])
        weights[far][at] = total
        rises[far][at] = np.maximum(rises[near][at], rise)
        colors[near][at], depths[near][at] = 0.0, np.inf
        rises[near][at] = 0.0
    for number, side in product(range(len(colors)), (SIDE, SIDE + 1)):
        # What the neighbouring layers have of a pixel may have faded with the ends of their slices.
        alpha = colors[number][..., 3]
        rows, columns = np.nonzero((alpha > 0.0) & (alpha < WHOLE) & (rises[number] == 0.0))
        # A strand of hair, too, may lie between what is nearer and what is farther, but then
        # something is behind it.
        behind = covers[number + 1 : number + 1 + _BESIDE]
        alone = sum((cover[rows, columns] for cover in behind), np.zeros(len(rows))) <= _MOST
        rows, columns = rows[alone], columns[alone]
        if not len(rows):
            continue
        rise, inside = _slope(covers, held, steps, (number, number), rows, columns, side)
        at = rows[inside], columns[inside]
        if inside.any():
            colors[number] = colors[number].copy()
            colors[number][at] /= colors[number][at][:, 3:]
            rises[number][at] = rise[inside]
    return Sunk(colors, depths, rises)


def _slope(covers, depths, steps, pair, rows, columns, side=SIDE):
    """Return by how much a surface rises that goes from one layer into the next, and where inside.

    With one layer as both: that comes out of layers before it, and goes on in those behind it.

    Returns
    -------
    rise : ndarray of shape (N,)
        0 where there is no such surface.
    inside : ndarray of bool, of shape (N,)
        It goes on to all sides.
    """
    height, width = covers[0].shape
    near, far = pair
    # The less of it there is, the more whole is what it is a part of.
    here = sum(covers[number][rows, columns] for number in {near, far})
    least = np.maximum(_MOST, 1.0 - here)
    before = range(max(near - _BESIDE, 0), near + 1)
    behind = range(far, min(far + 1 + _BESIDE, len(covers)))

    def at(pictures, number, y, x):
        place = np.clip(rows + y, 0, height - 1), np.clip(columns + x, 0, width - 1)
        return pictures[number][place]

    def total(numbers, y, x):
        return np.sum([at(covers, number, y, x) for number in numbers], axis=0)

    def step_of(numbers, y, x):
        # Parts of a pixel lie beside one another: what is behind a whole pixel does not count.
        found, filled = np.zeros(len(rows)), np.zeros(len(rows))
        for number in numbers:
            share = np.minimum(at(covers, number, y, x), 1.0 - filled)
            depth = np.where(share > 0.0, at(depths, number, y, x), 1.0)
            found += share * np.where(share > 0.0, steps(depth), 0.0)
            filled += share
        return found / np.maximum(filled, 1e-9)

    around = range(before[0], behind[-1] + 1)
    middle = step_of(around, 0, 0)
    rise, inside = np.zeros(len(rows)), np.zeros(len(rows), bool)
    for y, x in ((side, 0), (-side, 0), (0, side), (0, -side)):
        # The near side is the one, the far side the other.
        found = (at(covers, far, y, x) == 0.0) & (at(covers, near, -y, -x) == 0.0)
        found &= (total(before, y, x) > least) & (total(behind, -y, -x) > least)
        if not found.any():
            continue
        sides = step_of(before, y, x), step_of(behind, -y, -x)
        between = step_of(around, y // side, x // side), step_of(around, -y // side, -x // side)
        step = sides[1] - sides[0]
        found &= (step > 0.0) & (np.abs(middle - 0.5 * (sides[0] + sides[1])) < _BENT * step)
        found &= (sides[0] <= between[0]) & (between[0] <= middle)
        found &= (middle <= between[1]) & (between[1] <= sides[1])
        across = [total(around, *place) > least for place in ((x, y), (-x, -y))]
        rise = np.where(found, np.maximum(rise, step), rise)
        inside |= found & across[0] & across[1]
    return rise, inside
