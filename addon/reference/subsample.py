"""Numpy twins of N-buffers, blur bounds and subsample blur."""

import numpy as np


def nbuffers(depth, count):
    """Least and largest value over squares that begin at each texel.

    Parameters
    ----------
    depth : ndarray of shape (height, width)
    count : int
        Layers; layer i has squares of 2^i texels.

    Returns
    -------
    ndarray of shape (count, height, width, 2)
        As far as the squares lie in the picture.
    """
    height, width = depth.shape
    layers = np.empty((count, height, width, 2), depth.dtype)
    for i in range(count):
        for y in range(height):
            for x in range(width):
                square = depth[y : y + 2**i, x : x + 2**i]
                layers[i, y, x] = square.min(), square.max()
    return layers


def sweep_px(move, sweep, depth):
    """How far a surface moves between two places on the lens, in texels."""
    return np.asarray(move) * (sweep[:2] + sweep[2:] * depth)


def square_extremes(depth, x, y, reach):
    """Least and largest value within `reach` texels of one."""
    square = depth[max(y - reach, 0) : y + reach + 1, max(x - reach, 0) : x + reach + 1]
    return square.min(), square.max()


def blur_bounds(depth, sweep, opening, depth_range, iterations=3):
    """Nearest and farthest depth that can reach each pixel through the lens.

    Parameters
    ----------
    depth : ndarray of shape (height, width)
    sweep : ndarray of shape (4,)
    opening : ndarray of shape (2,)
    depth_range : tuple of 2 float
    iterations : int

    Returns
    -------
    ndarray of shape (height, width, 2)
    """
    bounds = np.empty((*depth.shape, 2))
    for y, x in np.ndindex(depth.shape):
        low, high = depth_range
        for _ in range(iterations):
            reach = max(
                np.abs(sweep_px(opening, sweep, low)).max(),
                np.abs(sweep_px(opening, sweep, high)).max(),
            )
            low, high = square_extremes(depth, x, y, int(np.ceil(reach)) + 1)
        bounds[y, x] = low, high
    return bounds


def subsample_sum(color, depth, bounds, offsets, sweep, tolerance=1.0):
    """Sum of a lens sample's picture and of those seen from places beside its own.

    Parameters
    ----------
    color : ndarray of shape (height, width, 4)
    depth : ndarray of shape (height, width)
    bounds : ndarray of shape (height, width, 2)
    offsets : ndarray of shape (K, 2)
        In m.
    sweep : ndarray of shape (4,)
    tolerance : float
        In texels.

    Returns
    -------
    total : ndarray of shape (height, width, 4)
    margin : ndarray of shape (height, width)
        How far the nearest decision was from turning out otherwise, in texels.
    """
    height, width = depth.shape
    total = np.zeros((height, width, 4))
    margin = np.full((height, width), np.inf)
    spread = np.abs(offsets).max(axis=0)
    for y, x in np.ndindex(depth.shape):
        ends = bounds[y, x]
        reach = max(np.abs(sweep_px(spread, sweep, d)).max() for d in ends)
        margin[y, x] = abs(reach - 0.5)
        if reach <= 0.5:
            total[y, x] = color[y, x] * (len(offsets) + 1)
            continue
        total[y, x] = color[y, x]
        for move in offsets:
            place, sure = _cast(np.array([x, y]) + 0.5, depth, ends, move, sweep, tolerance)
            total[y, x] += color[place]
            margin[y, x] = min(margin[y, x], sure)
    return total, margin


def _cast(center, depth, bounds, move, sweep, tolerance):
    """Return the texel that a ray hits, or what lies farthest on its way; and the margin."""
    near, far = (sweep_px(move, sweep, d) for d in bounds)
    way = near - far
    first, last = _part_inside(center - near, way, np.array(depth.shape[::-1]))
    start = center - near + way * first
    way = way * max(last - first, 0.0)
    length = np.abs(way).max()
    steps = int(np.ceil(length))
    # One step, whatever the rounding, if nothing lies before or behind.
    sure = abs(length - np.round(length)) if length > 0.0 else np.inf
    hit, closest, farthest, behind = None, tolerance, -1.0, None
    for k in range(steps + 1):
        place = start + way * (k / max(steps, 1))
        sure = min(sure, np.abs(place - np.round(place)).min())
        x, y = np.clip(np.floor(place).astype(int), 0, (depth.shape[1] - 1, depth.shape[0] - 1))
        miss = np.array([x, y]) + 0.5 + sweep_px(move, sweep, depth[y, x]) - center
        distance = np.abs(miss).max()
        sure = min(sure, abs(distance - closest)) if (y, x) != hit else sure
        if distance <= closest:
            hit, closest = (y, x), distance
        elif hit is not None:
            break
        if depth[y, x] > farthest:
            farthest, behind = depth[y, x], (y, x)
    return (behind if hit is None else hit), sure


def _part_inside(start, way, size):
    """From where to where a way, from 0 to 1, lies in the picture or within a texel of it."""
    first, last = 0.0, 1.0
    for axis in range(2):
        if abs(way[axis]) > 1.0:
            ends = np.array([-1.0, size[axis] + 1.0])
            a, b = sorted((ends - start[axis]) / way[axis])
            first, last = max(first, a), min(last, b)
    return np.clip([first, last], 0.0, 1.0)
