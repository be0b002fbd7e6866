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

from .layer_stack import is_world
from .sinking import WHOLE, sink

# Pixels that are copied before the farther layer's first whole one: colours are mixed between
# pixels, and where the cut goes through pixels both layers are whole in none of them.
REACH = 2
# Layers before one among which the other row of a gathered surface is looked for.
_FARTHEST_BEFORE = 12


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
    orthographic = stack.camera.orthographic
    kept = [layer for layer in stack.layers if not is_world(layer)]
    if not kept:
        return stack
    sunk = sink(
        [layer.color for layer in kept],
        [layer.depth for layer in kept],
        lambda depth: _steps(depth, orthographic),
    )
    colors, depths = list(sunk.colors), list(sunk.depths)
    # Where parts of thin slices were gathered, rows side by side may lie some layers apart.
    reach = _FARTHEST_BEFORE if sunk.any else 1
    for number in range(1, len(kept)):
        own = sunk.colors[number], sunk.depths[number]
        taken = np.zeros(own[1].shape, bool)
        for before in range(number - 1, max(number - 1 - reach, -1), -1):
            steps = [_steps(found, orthographic) for found in (depths[before], own[1])]
            coverages = [colors[before][..., 3], own[0][..., 3]]
            rises = None if before == number - 1 and not sunk.any else sunk.rises[before]
            ends = open_ends(coverages, steps, known_rises=rises)
            if before < number - 1:
                # Of what is not beside it in the stack only what was gathered.
                ends &= sunk.rises[before] > 0.0
            ends &= ~taken
            if not ends.any():
                continue
            if not taken.any():
                colors[number], depths[number] = colors[number].copy(), depths[number].copy()
            taken |= ends
            near, far = colors[before][ends], own[0][ends]
            color = near + (1.0 - near[:, 3:]) * far
            colors[number][ends] = color / color[:, 3:]
            depths[number][ends] = np.where(far[:, 3] > 0.0, own[1][ends], depths[before][ends])
    made = (
        layer
        if color is layer.color and depth is layer.depth
        else replace(layer, color=color, depth=depth)
        for layer, color, depth in zip(kept, colors, depths, strict=True)
    )
    return replace(
        stack, layers=tuple(layer if is_world(layer) else next(made) for layer in stack.layers)
    )


def open_ends(coverages, depths, reach=REACH, in_parts=False, known_rises=None):
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
    known_rises : ndarray of shape (height, width), optional
        By how much surfaces rise there at least, of the layer in front.

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
    if known_rises is not None:
        rises = np.maximum(rises, known_rises[rows, columns])
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
