"""Interpolation on regular grids with numpy alone: spline matrices and local cubics."""

import numpy as np


def spline_matrix(nodes, at):
    """Matrix of the cubic spline through values at nodes ("not a knot" at both ends).

    Parameters
    ----------
    nodes : ndarray of shape (N,)
        Rising, N >= 4.
    at : ndarray of shape (M,)
        Where values are wanted; outside of the nodes the end cubics go on.

    Returns
    -------
    ndarray of shape (M, N)
        ``matrix @ values`` are the interpolated values.
    """
    nodes, at = np.asarray(nodes, dtype=float), np.asarray(at, dtype=float)
    second = np.linalg.solve(*_bending(nodes))
    cell, below, above, lower, upper = _cubics(nodes, at)
    rows = np.arange(len(at))
    matrix = np.zeros((len(at), len(nodes)))
    matrix[rows, cell] += below
    matrix[rows, cell + 1] += above
    matrix += lower[:, None] * second[cell]
    matrix += upper[:, None] * second[cell + 1]
    return matrix


def spline_values(nodes, values, at):
    """Interpolate values at nodes; as ``spline_matrix(nodes, at) @ values``, for many places.

    Parameters
    ----------
    nodes, values : ndarray of shape (N,)
    at : ndarray of shape (M,)

    Returns
    -------
    ndarray of shape (M,)
    """
    left, right = _bending(nodes)
    second = np.linalg.solve(left, right @ values)
    cell, below, above, lower, upper = _cubics(nodes, at)
    result = below * values[cell] + above * values[cell + 1]
    result += lower * second[cell] + upper * second[cell + 1]
    return result


def _bending(nodes):
    """Return two matrices: that of the second derivatives, and that of the values they follow."""
    count = len(nodes)
    h = np.diff(nodes)
    # Second derivatives: continuity of the first derivative inside, of the third next to the ends.
    left, right = np.zeros((count, count)), np.zeros((count, count))
    for i in range(1, count - 1):
        left[i, i - 1 : i + 2] = h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i]
        right[i, i - 1 : i + 2] = 6.0 / h[i - 1], -6.0 / h[i - 1] - 6.0 / h[i], 6.0 / h[i]
    left[0, :3] = h[1], -h[0] - h[1], h[0]
    left[-1, -3:] = h[-1], -h[-1] - h[-2], h[-2]
    return left, right


def _cubics(nodes, at):
    """Return each place's cell, and what its ends' values and second derivatives count."""
    h = np.diff(nodes)
    cell = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    width = h[cell]
    b = (at - nodes[cell]) / width
    a = 1.0 - b
    square = width**2 / 6.0
    return cell, a, b, (a**3 - a) * square, (b**3 - b) * square


def cubic_taps(position, count):
    """Taps and weights of the local cubic (Catmull-Rom) on a regular grid.

    Parameters
    ----------
    position : ndarray of shape (...)
        In grid steps; outside of [0, count - 1] the last chord goes on.
    count : int
        Grid points, at least 3.

    Returns
    -------
    taps : ndarray of int, shape (4, ...)
    weights : ndarray of shape (4, ...)
        Sum 1.
    """
    cell = np.clip(np.floor(position), 0, count - 2).astype(int)
    t = np.clip(position - cell, 0.0, 1.0)
    beyond = position - cell - t
    first = np.stack(
        [
            -0.5 * t * (1.0 - t) ** 2,
            1.0 + t * t * (1.5 * t - 2.5),
            t * (0.5 + t * (2.0 - 1.5 * t)),
            -0.5 * t * t * (1.0 - t),
        ]
    )
    slope = np.stack([np.zeros_like(t), -np.ones_like(t), np.ones_like(t), np.zeros_like(t)])
    weights = first + beyond * slope
    # The missing neighbour of an end goes on as a parabola: f[-1] = 3 f[0] - 3 f[1] + f[2].
    low, high = cell == 0, cell == count - 2
    for end, missing, near, middle, far in ((low, 0, 1, 2, 3), (high, 3, 2, 1, 0)):
        extra = np.where(end, weights[missing], 0.0)
        weights[near] += 3.0 * extra
        weights[middle] -= 3.0 * extra
        weights[far] += extra
        weights[missing] -= extra
    taps = np.clip(cell + np.arange(-1, 3).reshape(-1, *(1,) * np.ndim(cell)), 0, count - 1)
    return taps, weights
