"""Numpy twins of N-buffers, blur bounds, pyramid and subsample blur."""

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


def pyramid(color, depth, count):
    """Means of colour and extremes of depth over ever larger squares.

    Parameters
    ----------
    color : ndarray of shape (height, width, 4)
    depth : ndarray of shape (height, width)
    count : int

    Returns
    -------
    list of (ndarray of shape (h, w, 4), ndarray of shape (h, w, 2))
        Level i has squares of 2^i texels; the last texel of an odd row or column counts twice.
    """
    levels = [(color, np.stack([depth, depth], axis=-1))]
    for _ in range(count):
        means, ranges = (np.pad(a, [(0, s % 2) for s in a.shape[:2]] + [(0, 0)], "edge")
                         for a in levels[-1])  # fmt: skip
        squares = [(slice(i, None, 2), slice(j, None, 2)) for i in (0, 1) for j in (0, 1)]
        least = np.min([ranges[square][..., 0] for square in squares], axis=0)
        most = np.max([ranges[square][..., 1] for square in squares], axis=0)
        mean = np.mean([means[square] for square in squares], axis=0)
        levels.append((mean, np.stack([least, most], axis=-1)))
    return levels


def subsample_sum(levels, bounds, offsets, sweep, cell, tolerance=1.0):
    """Sum of a lens sample's picture and of those seen from places beside its own.

    Parameters
    ----------
    levels : list of (ndarray, ndarray)
        See `pyramid`.
    bounds : ndarray of shape (height, width, 2)
    offsets : ndarray of shape (K, 2)
        In m.
    sweep : ndarray of shape (4,)
    cell : float
        Side of the part of the lens that a place stands for, m.
    tolerance : float
        In texels.

    Returns
    -------
    total : ndarray of shape (height, width, 4)
    margin : ndarray of shape (height, width)
        How far the nearest decision was from turning out otherwise, in texels.
    """
    color, depth = levels[0][0], levels[0][1][..., 0]
    total = np.zeros(color.shape)
    margin = np.full(depth.shape, np.inf)
    spread = np.abs(offsets).max(axis=0)
    for y, x in np.ndindex(depth.shape):
        ends = bounds[y, x]
        reach = max(np.abs(sweep_px(spread, sweep, d)).max() for d in ends)
        margin[y, x] = abs(reach - 0.5)
        if reach <= 0.5:
            total[y, x] = color[y, x] * (len(offsets) + 1)
            continue
        total[y, x], sure = _cell_color(levels, (y, x), sweep, cell)
        margin[y, x] = min(margin[y, x], sure)
        for move in offsets:
            place, sure = _cast(np.array([x, y]) + 0.5, depth, ends, move, sweep, tolerance)
            seen, sure_of_color = _cell_color(levels, place, sweep, cell)
            total[y, x] += seen
            margin[y, x] = min(margin[y, x], sure, sure_of_color)
    return total, margin


def _cell_color(levels, texel, sweep, cell, alike=1.0, width_of_cell=0.85):
    """Return the mean of the colours round a texel that a cell brings to one pixel; the margin."""
    depth = levels[0][1][texel][0]
    width = width_of_cell * np.abs(sweep_px([cell, cell], sweep, depth)).min()
    wanted = np.log2(max(width, 1.0)) + 0.5
    sure = min(wanted % 1.0, -wanted % 1.0) if wanted > 0.5 else np.inf
    for level in range(min(int(wanted), len(levels) - 1), 0, -1):
        means, ranges = levels[level]
        last = np.array(means.shape[:2]) - 1
        place = (np.array(texel) + 0.5) / 2**level - 0.5
        low = np.clip(np.floor(place).astype(int), 0, last)
        high = np.minimum(low + 1, last)
        part = np.clip(place - low, 0.0, 1.0)
        corners = np.ix_(*([a, b] for a, b in zip(low, high, strict=True)))
        extent = np.ptp(ranges[corners])
        moves = cell * np.abs(sweep[2:]).max() * extent
        sure = min(sure, abs(moves - alike))
        if moves <= alike:
            weights = np.outer(*([1.0 - p, p] for p in part))
            return np.einsum("ij,ijc->c", weights, means[corners]), sure
    return levels[0][0][texel], sure


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
