"""Joins the depth layers of a picture where a surface goes on from one into the next.

Slices overlap, but where a pixel of a surface is deeper than the overlap (a floor at a grazing
angle, few layers, a small picture) the one layer ends in a row of pixels and the next begins
in the following row. Laid over each other they are whole; rays from elsewhere on the lens pass
between the two rows. There the farther layer gets the last pixels of the nearer one: a ray then
finds the two rows side by side in one layer. Nothing is seen that was not there, since a
pixel is only copied, at its own depth.
"""

from dataclasses import replace

import numpy as np

from .layer_file import is_world

# Coverage of a pixel that nothing is seen through: a sample's share may be lost in rounding.
WHOLE = 1.0 - 1e-3
# Pixels that are copied before the farther layer's first whole one: colours are mixed between
# pixels, and where the cut goes through pixels both layers are whole in none of them.
REACH = 2


def join_layers(stack):
    """Return a captured picture whose layers overlap by whole pixels wherever a surface goes on.

    Parameters
    ----------
    stack : LayerStack

    Returns
    -------
    LayerStack
        Layers that nothing is added to are those of `stack`, and so is what they hold.
    """
    joined = list(stack.layers)
    for number in range(1, len(joined)):
        before, layer = joined[number - 1], stack.layers[number]
        if is_world(layer):
            # No surface goes on into it, and it stays without any depth.
            continue
        depths = [_steps(found.depth, stack.camera.orthographic) for found in (before, layer)]
        coverages = [found.color[..., 3] for found in (before, layer)]
        ends = open_ends(coverages, depths)
        if not ends.any():
            continue
        color, depth = layer.color.copy(), layer.depth.copy()
        color[ends] = before.color[ends] + (1.0 - before.color[ends, 3:]) * layer.color[ends]
        color[ends] /= color[ends, 3:]
        depth[ends] = np.where(layer.color[ends, 3] > 0.0, layer.depth[ends], before.depth[ends])
        joined[number] = replace(layer, color=color, depth=depth)
    return replace(stack, layers=tuple(joined))


def open_ends(coverages, depths, reach=REACH, in_parts=False):
    """Find the pixels that a layer lacks of a surface that comes out of the layer in front of it.

    They are not whole in the layer, but are together with the one in front, and lie beside pixels
    that are whole in the layer alone. That is also so at an edge of an object where by chance
    something behind ends, too: the surface is one only if the step in depth is no more than what
    both layers rise by in a few pixels.

    Parameters
    ----------
    coverages : pair of ndarray of shape (height, width)
        Of the layer in front and the layer.
    depths : pair of ndarray of shape (height, width)
        In a measure that planes are linear in over the picture; of any value where nothing is.
    reach : int
        How far from a pixel that is whole, in pixels.
    in_parts : bool
        Parts of a pixel that the two layers have of a surface are the whole together, however
        small: rays take them from the one or from the other layer. Then no pixel that the layer in
        front has a part of counts as the layer's alone.

    Returns
    -------
    ndarray of bool, of shape (height, width)
    """
    front, behind = coverages
    whole = behind >= WHOLE
    first = whole & (front <= 0.0 if in_parts else front < WHOLE)
    together = front + (1.0 - front) * behind >= WHOLE
    found = ~whole & (front > 0.0) & (together | in_parts)
    found &= _near(first, reach)
    rows, columns = np.nonzero(found)
    if not len(rows):
        return found
    side = range(-reach - 1, reach + 2)
    rises = np.zeros(len(rows))
    for held, depth in zip((front > 0.0, first), depths, strict=True):
        held = _around(np.where(held, depth, np.nan), rows, columns, side)
        rises += np.nanmax(held, axis=0) - np.nanmin(held, axis=0)
    side = range(-reach, reach + 1)
    beside = _around(np.where(first, depths[1], np.nan), rows, columns, side)
    here = depths[0][rows, columns]
    steps = np.nanmin(np.abs(beside - here), axis=0)
    own = np.where(behind[rows, columns] > 0.0, depths[1][rows, columns] - here, 0.0)
    found[rows, columns] = np.maximum(steps, np.abs(own)) <= rises
    return found


def _steps(depth, orthographic):
    """Return a measure of depth that planes are linear in over the picture."""
    if orthographic:
        return depth
    with np.errstate(divide="ignore"):
        return -1.0 / depth


def _near(found, reach):
    """Whether something was found so near, in pixels across and up."""
    height, width = found.shape
    side = range(2 * reach + 1)
    padded = np.pad(found, ((reach, reach), (0, 0)))
    found = np.any([padded[y : y + height] for y in side], axis=0)
    padded = np.pad(found, ((0, 0), (reach, reach)))
    return np.any([padded[:, x : x + width] for x in side], axis=0)


def _around(values, rows, columns, side):
    """Return the values around pixels, first axis: the places; beyond the edge that of the edge."""
    height, width = values.shape
    return np.stack(
        [
            values[np.clip(rows + y, 0, height - 1), np.clip(columns + x, 0, width - 1)]
            for y in side
            for x in side
        ]
    )
