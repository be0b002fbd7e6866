"""The highlights of a captured picture: pixels of its layers brighter than the threshold.

What they are depends on the threshold alone, so that they are found once for many settings of the
lens. With them come the see-through pixels of other layers at the same places, which dim what lies
right behind them.
"""

from dataclasses import dataclass

import numpy as np

from ...passes.layered.layers import EMPTY

# Coverage from which on a pixel hides what is behind it; as in passes/bokeh/peel_frag.glsl.
OPAQUE_FROM = 0.999
# Least step of the depth buffer's values from layer to layer at one place: the farther layer lies
# behind the nearer one, also where both have the same surface, and by more than what
# passes/bokeh/highlights_order_comp.glsl takes for one depth.
_STEP = 5e-7
# Largest difference of the depth buffer's values, as a share of their distance from infinity, of
# one surface that lies in two layers.
_SAME_SURFACE = 1e-3
# Most pixels that are listed together, to bound memory.
_MOST_LISTED = 1 << 21


@dataclass(frozen=True, eq=False)
class StackHighlights:
    """Highlights of a captured picture, by place in its raster.

    Parameters
    ----------
    surfaces, world : Entries
        Of the layers with a depth, those that dim highlights included, and of the world.
    nearest : ndarray of shape (height, width)
        float32, value of the depth buffer of the nearest pixel that hides what is behind it, where
        there is a highlight; `EMPTY` elsewhere.
    """

    surfaces: "Entries"
    world: "Entries"
    nearest: np.ndarray


@dataclass(frozen=True, eq=False)
class Entries:
    """Pixels of layers, in the order of their places.

    Parameters
    ----------
    place : ndarray of shape (N, 4)
        float32: column and row in the raster, layer, value of the depth buffer.
    light : ndarray of shape (N, 4)
        float32: radiance of what covers the pixel, and how much of it is covered.
    front : ndarray of shape (N, 2)
        float32, value of the depth buffer of the last pixel before it that hides what is behind it,
        0 where there is none, and the share of the light that passes it: 0, but before the world,
        where the last pixel counts that covers anything.
    """

    place: np.ndarray
    light: np.ndarray
    front: np.ndarray


def find_highlights(stack, depths, threshold):
    """Find the highlights of a captured picture.

    Parameters
    ----------
    stack : LayerStack
    depths : ndarray of shape (layers, height, width)
        Values of the depth buffer; `EMPTY` where nothing is.
    threshold : float
        Radiance of the largest channel.

    Returns
    -------
    StackHighlights
    """
    bright = np.zeros(depths.shape, bool)
    for number, layer in enumerate(stack.layers):
        peak = layer.color[..., :3].max(axis=-1)
        bright[number] = (peak > threshold * layer.color[..., 3]) & (depths[number] <= 1.0)
    at_infinity = np.array([not np.isfinite(layer.depth).any() for layer in stack.layers])
    world = bright & at_infinity[:, None, None]
    world = _entries(stack, depths, world, _before_world(stack, depths, at_infinity))
    bright &= ~at_infinity[:, None, None]
    rows, columns = np.nonzero(bright.any(axis=0))
    values = depths[:, rows, columns].astype(np.float64)
    alpha = np.stack([layer.color[rows, columns, 3] for layer in stack.layers])
    covered = (values <= 1.0) & ~at_infinity[:, None]
    opaque = covered & (alpha >= OPAQUE_FROM)
    last, hiding = np.zeros(len(rows)), np.zeros(values.shape)
    for number in range(len(values)):
        behind = np.maximum(values[number], last + _STEP)
        values[number] = np.where(covered[number], behind, values[number])
        last = np.where(covered[number], values[number], last)
        if number + 1 < len(values):
            hiding[number + 1] = np.where(opaque[number], values[number], hiding[number])
    nearest = np.full(depths.shape[1:], EMPTY, np.float32)
    nearest[rows, columns] = np.where(opaque, values, EMPTY).min(axis=0, initial=EMPTY)
    shown, wanted = np.array(depths), np.array(bright)
    fronts = np.zeros((*depths.shape, 2), np.float32)
    shown[:, rows, columns] = values
    fronts[:, rows, columns, 0] = hiding
    wanted[:, rows, columns] |= covered & ~opaque
    return StackHighlights(_entries(stack, shown, wanted, fronts), world, nearest)


def seen_from_middle(stack, depths):
    """Lay a captured picture's layers over one another, as the lens' middle sees them.

    Parameters
    ----------
    stack : LayerStack
    depths : ndarray of shape (layers, height, width)
        Values of the depth buffer; `EMPTY` where nothing is.

    Returns
    -------
    color : ndarray of shape (height / 2, width / 2, 4)
        float32, means of two by two pixels, sides rounded up.
    depth : ndarray of shape (height / 2, width / 2)
        float32, of one of the four: the value of what covers it first, 1 where nothing does.
    """
    color, depth = np.zeros((*depths.shape[1:], 4), np.float32), np.ones(depths.shape[1:])
    for layer, values in zip(stack.layers, depths, strict=True):
        here = (values <= 1.0)[..., None]
        depth = np.where((color[..., 3] == 0.0) & here[..., 0], values, depth)
        color += np.where(here, (1.0 - np.clip(color[..., 3:], 0.0, 1.0)) * layer.color, 0.0)
    color = np.pad(color, [(0, side % 2) for side in depths.shape[1:]] + [(0, 0)], "edge")
    color = color.reshape(color.shape[0] // 2, 2, color.shape[1] // 2, 2, 4).mean(axis=(1, 3))
    return color.astype(np.float32), np.ascontiguousarray(depth[::2, ::2], np.float32)


def _before_world(stack, depths, at_infinity):
    """Return depth and transmittance in front of the world in each pixel, as `Entries.front`."""
    last = np.zeros(depths.shape[1:], np.float32)
    through = np.ones_like(last)
    for layer, values, is_world in zip(stack.layers, depths, at_infinity, strict=True):
        covers = (values <= 1.0) & (not is_world)
        passes = 1.0 - np.clip(layer.color[..., 3], 0.0, 1.0)
        same = np.abs(values - last) <= _SAME_SURFACE * (1.0 - last)
        through = np.where(covers, np.where(same, through, 1.0) * passes, through)
        last = np.where(covers, np.maximum(values, last), last)
    through[through <= 1.0 - OPAQUE_FROM] = 0.0
    return np.broadcast_to(np.stack([last, through], axis=-1), (*depths.shape, 2))


def runs_of(entries):
    """Return first and number of entries that are listed together, at whole places.

    Parameters
    ----------
    entries : Entries

    Returns
    -------
    tuple of (int, int)
    """
    count = len(entries.place)
    if count <= _MOST_LISTED:
        return ((0, count),) if count else ()
    place = entries.place[:, :2]
    starts = np.flatnonzero(np.any(place[1:] != place[:-1], axis=1)) + 1
    chosen = np.searchsorted(starts, np.arange(_MOST_LISTED, count, _MOST_LISTED))
    ends = np.unique([0, *starts[np.minimum(chosen, len(starts) - 1)].tolist(), count])
    return tuple((int(a), int(b - a)) for a, b in zip(ends[:-1], ends[1:], strict=True))


def _entries(stack, depths, wanted, fronts):
    """Return the wanted pixels, those of one place behind one another."""
    rows, columns, numbers = np.nonzero(np.moveaxis(wanted, 0, -1))
    light = np.empty((len(rows), 4), np.float32)
    for number, layer in enumerate(stack.layers):
        here = numbers == number
        light[here] = layer.color[rows[here], columns[here]]
    light[:, :3] /= light[:, 3:]
    place = np.stack([columns, rows, numbers, depths[numbers, rows, columns]], axis=1)
    return Entries(place.astype(np.float32), light, fronts[numbers, rows, columns])
