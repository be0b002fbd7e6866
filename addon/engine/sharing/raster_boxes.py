"""Where the boxes of objects are in the rasters of all lens samples of a frame."""

import numpy as np

from ...levels.choosing import coc_ends


def raster_rectangles(corners, plan):
    """Return the rectangles that boxes may cover in the raster of any lens sample.

    Parameters
    ----------
    corners : ndarray of shape (R, 8, 3)
        In world space.
    plan : FramePlan

    Returns
    -------
    rectangles : ndarray of shape (R, 4)
        int: x, y, width, height.
    inside : ndarray of shape (R,)
        bool; False where it is outside or reaches behind the camera.
    """
    eye = corners @ plan.view[:3, :3].T + plan.view[:3, 3]
    front = (_clip(eye, plan)[..., 3] > 0.0).all(axis=1)
    # Of what reaches behind the camera nothing is used.
    eye = np.where(front[:, None, None], eye, (0.0, 0.0, -plan.focus_distance))
    size = np.array([plan.width, plan.height])
    clip = _clip(eye, plan)[:, None]
    narrowing = plan.lens_extent / max(plan.lens_extent[1], 1e-30)
    focus = None
    if plan.chromatic is not None:
        ranges = plan.chromatic.ranges(eye)
        focus = np.repeat(ranges.inverse_focus, 8, axis=1)
        grown = np.repeat(eye[:, None], 2, axis=1)
        grown[..., :2] *= ranges.scale.T[:, :, None, None]
        clip = _clip(grown, plan)
    # Shape (R, wavelengths, 8, 2).
    places = (clip[..., :2] / clip[..., 3:] + 1.0) / 2.0 * size
    depth = -eye[..., 2].ravel()
    blur = np.abs(coc_ends(depth, depth, plan, focus)).max(axis=0)
    blur = blur.reshape(-1, 1, 8, 1) * narrowing
    # Margin for rounding by the rasteriser, and of the jitter to whole pixels.
    margin = np.abs(plan.jitter).max(axis=0, initial=0.0) * size / 2.0 + 2.0
    low, high = (places - blur).min(axis=(1, 2)), (places + blur).max(axis=(1, 2))
    rectangles, inside = whole_rectangles(low - margin, high + margin, size)
    return rectangles, inside & front


def whole_rectangles(low, high, size):
    """Return the parts of a raster between two corners, in whole pixels.

    Parameters
    ----------
    low, high : ndarray of shape (R, 2)
        In px.
    size : ndarray of shape (2,)
        Of the raster.

    Returns
    -------
    rectangles : ndarray of shape (R, 4)
        int: x, y, width, height.
    inside : ndarray of shape (R,)
        bool; whether anything is left.
    """
    low = np.clip(np.floor(low), 0, size).astype(int)
    high = np.clip(np.ceil(high), 0, size).astype(int)
    return np.concatenate([low, high - low], axis=1), (high > low).all(axis=1)


def _clip(eye, plan):
    return eye @ plan.projection[:, :3].T + plan.projection[:, 3]
