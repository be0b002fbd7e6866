"""Numpy twin of `passes.picture_error`: the error of a picture, from its change, in windows."""

import numpy as np

from addon.sampling.tile_control import TILE

STRIDE, RADIUS, SIGMA = 4, 5, 1.5
C1, C2 = 0.01**2, 0.03**2


def displayed(linear):
    """Encode scene-linear colours (..., 4) for sRGB, clipped; alpha is only clipped."""
    x = np.clip(np.nan_to_num(np.asarray(linear, np.float64), posinf=1.0, neginf=0.0), 0.0, 1.0)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    return np.concatenate([encoded[..., :3], x[..., 3:]], axis=-1)


def window_errors(picture, earlier, rest):
    """Estimate how much a picture differs from what it converges to.

    Parameters
    ----------
    picture, earlier : ndarray of shape (height, width, 4)
        As displayed.
    rest : float
        Variance of the picture's error over that of its change since the earlier one.

    Returns
    -------
    errors, changes : ndarray of shape (rows, columns)
        1 - SSIM, and the variance of the change, in windows every `STRIDE` px.
    """
    height, width = picture.shape[:2]
    weight = np.exp(-0.5 * (np.arange(-RADIUS, RADIUS + 1) / SIGMA) ** 2)
    weight = np.outer(weight, weight) / weight.sum() ** 2
    errors = np.empty((-(-height // STRIDE), -(-width // STRIDE)))
    changes = np.empty_like(errors)
    for row, column in np.ndindex(errors.shape):
        rows, columns = _window(row, height), _window(column, width)
        x = picture[np.ix_(rows, columns)]
        d = x - earlier[np.ix_(rows, columns)]

        def mean(values):
            return np.einsum("ij,ijc->c", weight, values)

        mean_x, mean_d = mean(x), mean(d)
        spread = np.maximum(mean(x * x) - mean_x**2, 0.0)
        change = np.maximum(mean(d * d) - mean_d**2, 0.0)
        noise, shift = rest * change, rest * mean_d**2
        structure = noise / (spread + np.maximum(spread - noise, 0.0) + C2)
        level = shift / (mean_x**2 + np.maximum(mean_x**2 - shift, 0.0) + C1)
        error = 1.0 - (1.0 - np.minimum(structure, 1.0)) * (1.0 - np.minimum(level, 1.0))
        errors[row, column] = max(error[:3].mean(), error[3])
        changes[row, column] = max(change[:3].mean(), change[3])
    return errors, changes


def tile_means(windows):
    """Return the mean of the windows of each tile."""
    count = TILE // STRIDE
    rows, columns = windows.shape
    tiles = np.empty((-(-rows // count), -(-columns // count)))
    for row, column in np.ndindex(tiles.shape):
        part = windows[row * count : (row + 1) * count, column * count : (column + 1) * count]
        tiles[row, column] = part.mean()
    return tiles


def _window(number, size):
    center = number * STRIDE + STRIDE // 2
    if size > 2 * RADIUS:
        center = min(max(center, RADIUS), size - 1 - RADIUS)
    return np.clip(np.arange(center - RADIUS, center + RADIUS + 1), 0, size - 1)
