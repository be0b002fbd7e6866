"""The distorted picture, in numpy: twin of ``lib/distortion_lib.glsl``."""

import numpy as np

# As in the shader.
_LEAST_SPREAD = 0.04


def distorted_picture(raster, distortion):
    """Sample a picture from a raster without distortion.

    Parameters
    ----------
    raster : ndarray of shape (H, W, channels)
    distortion : engine.planning.distortion.DistortionPlan

    Returns
    -------
    ndarray of shape (height, width, channels)
    """
    centres = distortion.centres()
    field = centres * distortion.to_field[:2] + distortion.to_field[2:]
    away = field * distortion.from_field[:2]
    far = np.linalg.norm(away, axis=-1, keepdims=True)
    away = np.where(far > 0.0, away / np.maximum(far, 1e-30), (1.0, 0.0))
    growth = distortion.growth(centres)
    blur = distortion.filter_width / np.sqrt(12.0)
    spread = blur * np.sqrt(np.maximum(growth**2 - 1.0, 0.0))
    spread[spread <= _LEAST_SPREAD] = 0.0
    along = away * spread[..., :1]
    across = np.stack([-away[..., 1], away[..., 0]], axis=-1) * spread[..., 1:]
    places = distortion.sources(centres)
    return np.mean(
        [cubic_sample(raster, places + i * along + j * across) for i in (-1, 1) for j in (-1, 1)],
        axis=0,
    )


def cubic_sample(raster, places):
    """Interpolate by cubics, within the range of the 16 neighbours.

    Parameters
    ----------
    raster : ndarray of shape (H, W, channels)
    places : ndarray of shape (..., 2)
        x and y, px; the middle of the first pixel is at 0.5.

    Returns
    -------
    ndarray of shape (..., channels)
    """
    at = places - 0.5
    first = np.floor(at).astype(int)
    columns, rows = np.moveaxis(_weights(at - first), -2, 0)
    height, width = raster.shape[:2]
    x = np.clip(first[..., :1] + np.arange(-1, 3), 0, width - 1)
    y = np.clip(first[..., 1:] + np.arange(-1, 3), 0, height - 1)
    around = raster[y[..., :, None], x[..., None, :]]
    total = np.einsum("...j,...i,...jic->...c", rows, columns, around)
    return np.clip(total, around.min(axis=(-3, -2)), around.max(axis=(-3, -2)))


def _weights(t):
    s = 1.0 - t
    return np.stack(
        [
            -0.5 * t * s * s,
            1.0 + t * t * (1.5 * t - 2.5),
            1.0 + s * s * (1.5 * s - 2.5),
            -0.5 * s * t * t,
        ],
        axis=-1,
    )
