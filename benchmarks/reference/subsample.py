"""Numpy twins of the pyramid of a lens sample and of its subsample blur."""

import numpy as np


def sweep_px(move, sweep, depth):
    """How far a surface moves between two places on the lens, in texels."""
    return np.asarray(move) * (sweep[:2] + sweep[2:] * depth)


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


def subsample_sum(levels, top, offsets, sweep, cell, shifts, jitter=(0.0, 0.0)):
    """Sum of a lens sample's picture and of those seen from places beside its own.

    Parameters
    ----------
    levels : list of (ndarray, ndarray)
        See `pyramid`; as many as hold what is in reach.
    top : int
        Levels of means that are used.
    offsets : ndarray of shape (K, 2)
        In m.
    sweep : ndarray of shape (4,)
    cell : float
        Side of the part of the lens that a place stands for, m.
    shifts : ndarray of shape (K, 2)
        From a pixel's centre to the place that is looked at, texels.
    jitter : sequence of 2 float
        As `shifts`, near the picture's edges.

    Returns
    -------
    total : ndarray of shape (height, width, 4)
    margin : ndarray of shape (height, width)
        How far the nearest decision was from turning out otherwise, in texels.
    """
    color, depth = levels[0][0], levels[0][1][..., 0]
    total = np.zeros(color.shape)
    margin = np.full(depth.shape, np.inf)
    spread, apart = np.abs(offsets).max(axis=0), np.abs(shifts).max(axis=0)
    last = np.array(depth.shape)[::-1] - 1
    for y, x in np.ndindex(depth.shape):
        in_reach, reach, sure = _depths_in_reach(levels, (y, x), spread, sweep, apart)
        margin[y, x] = sure
        if reach == 0:
            total[y, x] = color[y, x] * (len(offsets) + 1)
            continue
        total[y, x], sure = _cell_color(levels, top, (y, x), sweep, cell)
        margin[y, x] = min(margin[y, x], sure)
        pixel = np.array([x, y])
        inside = np.minimum(pixel, last - pixel) + 0.5 > apart
        for move, shift in zip(offsets, shifts, strict=True):
            center = pixel + 0.5 + np.where(inside, shift, jitter)
            texel, sure = seen_texel(levels, center, in_reach, move, sweep)
            seen, sure_of_color = _cell_color(levels, top, texel, sweep, cell)
            total[y, x] += seen
            margin[y, x] = min(margin[y, x], sure, sure_of_color)
    return total, margin


def _cell_color(levels, top, texel, sweep, cell, alike=1.0, width_of_cell=0.85):
    """Return the mean of the colours round a texel that a cell brings to one pixel; the margin."""

    def level_of(depth):
        width = width_of_cell * np.abs(sweep_px([cell, cell], sweep, depth)).min()
        wanted = np.log2(max(width, 1.0)) + 0.5
        return int(wanted), min(wanted % 1.0, -wanted % 1.0) if wanted > 0.5 else np.inf

    wanted, sure = level_of(levels[0][1][texel][0])
    for level in range(min(wanted, top), 0, -1):
        means, ranges = levels[level]
        last = np.array(means.shape[:2]) - 1
        place = (np.array(texel) + 0.5) / 2**level - 0.5
        low = np.clip(np.floor(place).astype(int), 0, last)
        high = np.minimum(low + 1, last)
        part = np.clip(place - low, 0.0, 1.0)
        corners = np.ix_(*([a, b] for a, b in zip(low, high, strict=True)))
        extent = np.ptp(ranges[corners])
        moves = cell * np.abs(sweep[2:]).max() * extent
        around = ranges[corners]
        ends = [level_of(depth) for depth in (around[..., 0].min(), around[..., 1].max())]
        sure = min(sure, abs(moves - alike), *(margin for _, margin in ends))
        if moves <= alike and min(end for end, _ in ends) >= level:
            weights = np.outer(*([1.0 - p, p] for p in part))
            return np.einsum("ij,ijc->c", weights, means[corners]), sure
    return levels[0][0][texel], sure


def _seen_depths(levels, a, b):
    """Return least and largest depth over a rectangle of texels (y, x) and the squares it meets."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    level = max(int((high - low).max()).bit_length(), 1)
    ranges = levels[level][1]
    met = ranges[np.ix_(*([c, d] for c, d in zip(low >> level, high >> level, strict=True)))]
    return np.array([met[..., 0].min(), met[..., 1].max()])


def _depths_in_reach(levels, texel, spread, sweep, apart, approaches=3):
    """Return the depths of what may come to a pixel, from how far, and the margin of none."""
    depth = levels[0][1]
    found = np.array([depth.min(), 1.0])
    texel, last = np.array(texel), np.array(depth.shape[:2]) - 1
    for i in range(approaches + 1):
        moved = np.max([np.abs(sweep_px(spread, sweep, d)) for d in found], axis=0)
        moved = (moved + apart + 0.5).max()
        reach = int(min(moved, max(depth.shape)))
        if reach == 0 or i == approaches:
            break
        window = np.maximum(texel - reach, 0), np.minimum(texel + reach, last)
        seen = _seen_depths(levels, *window)
        if (seen == found).all():
            break
        found = seen
    return found, reach, abs(moved - 1.0)


def _way(center, size, move, sweep, depths):
    """Return start (x, y) and course of a way, its part in the picture, and its end texels."""
    start = center - sweep_px(move, sweep, depths[0])
    along = center - sweep_px(move, sweep, depths[1]) - start
    part = [0.0, 1.0]
    for axis in range(2):
        low, high = sorted((start[axis], start[axis] + along[axis]))
        if high < 0.0 or low > size[axis]:
            start[axis] = 0.5 if start[axis] < 0.0 else size[axis] - 0.5
            along[axis] = 0.0
        elif low < 0.0 or high > size[axis]:
            meets = sorted((edge - start[axis]) / along[axis] for edge in (0.0, size[axis]))
            part = [max(part[0], meets[0]), min(part[1], meets[1])]
    part[1] = max(part)
    ends = [np.clip(np.floor(start + along * p).astype(int), 0, size - 1) for p in part]
    return start, along, part, ends


def seen_texel(levels, center, in_reach, move, sweep, stretch=1.0):
    """Find what is seen at a place of the picture from a place on the lens beside the sample's.

    Parameters
    ----------
    levels : list of (ndarray, ndarray)
    center : ndarray of shape (2,)
        The place, x and y, in texels of the sample.
    in_reach : sequence of 2 float
        Least and largest depth of what may come there.
    move : ndarray of shape (2,)
        From the sample's place on the lens to the other, m.
    sweep : ndarray of shape (4,)
    stretch : float
        Neighbours are one surface if the move parts them by no more texels.

    Returns
    -------
    seen : tuple of 2 int
        Row and column.
    margin : float
        See `subsample_sum`.
    """
    depth = levels[0][1][..., 0]
    size = np.array(depth.shape[::-1])
    depths = np.array(in_reach, float)
    start, along, part, ends = _way(center, size, move, sweep, depths)
    place = start + along * part[0]
    inside = (place > 1e-9) & (place < size - 1e-9)
    sure = np.abs(place - np.round(place))[inside].min(initial=np.inf)
    at = ends[0].copy()
    moving = np.abs(along) > 1e-6
    crosses = np.where(moving, 1.0 / np.maximum(np.abs(along), 1e-6), 1e30)
    middle = np.where(moving, (at + 0.5 - start) * np.sign(along) * crosses, 0.0)
    leaves = middle + 0.5 * crosses
    entered = (middle - 0.5 * crosses).max()
    extent = max(np.ptp(depths), 1e-20)
    apart = np.abs(move * sweep[2:]).max()
    ahead, depth_ahead = tuple(at[::-1]), None
    for steps in range(np.abs(ends[1] - ends[0]).sum() + 1):
        here = tuple(at[::-1])
        reaches = depths[0] + extent * np.array([entered, leaves.min()])
        sure = min(sure, apart * np.abs(depth[here] - reaches).min())
        if depth[here] > reaches[1]:
            ahead, depth_ahead = here, depth[here]
        elif depth[here] >= reaches[0]:
            return here, sure
        else:
            if depth_ahead is None:
                if steps == 0:
                    return ahead, sure
            else:
                gap = apart * (depth_ahead - depth[here])
                sure = min(sure, abs(gap - stretch))
                if gap <= stretch:
                    return ahead, sure
            depth_ahead = None
        left = np.abs(ends[1] - at)
        if left.any():
            if left.all():
                sure = min(sure, abs(leaves[0] - leaves[1]) * np.abs(along).max())
            axis = 0 if left[1] == 0 or (left[0] > 0 and leaves[0] <= leaves[1]) else 1
            entered = leaves[axis]
            leaves[axis] += crosses[axis]
            at[axis] += int(np.sign(along[axis]))
    return ahead, sure
