"""Twin of `passes.bokeh.marks`: marks of highlights on a dimmed picture, mark by mark."""

import numpy as np

# Of white, and at most.
_DIMMED = 0.25


def draw_marks(picture, centers, sizes, colors, shape, line=0.5, opacity=1.0, ratio=1.0):
    """Lay marks over a picture, in order.

    Parameters
    ----------
    picture : ndarray of shape (height, width, 4)
        Premultiplied; changed in place.
    centers : ndarray of shape (N, 2)
        From the lower left corner, px.
    sizes : ndarray of shape (N,)
        Half the side of a dot or outline, or the radius of a ring across its shorter axis, px.
    colors : ndarray of shape (N, 3)
    shape : {'DOT', 'OUTLINE', 'RING'}
    line : float
        Half the width of a line, px.
    opacity : float
        Of rings.
    ratio : float
        Height of a ring over its width.
    """
    height, width, _ = picture.shape
    y, x = np.mgrid[:height, :width] + 0.5
    for (column, row), size, color in zip(centers, sizes, colors, strict=True):
        u, v = x - column, y - row
        if shape == "RING":
            radius = np.maximum(np.hypot(u * ratio, v), 1e-6)
            slope = np.hypot(u * ratio**2, v) / radius
            away = np.abs(radius - size) / np.maximum(slope, 1e-6) - line
        else:
            away = np.maximum(np.abs(u), np.abs(v)) - size
            if shape == "OUTLINE":
                away = np.abs(away) - line
        alpha = np.clip(0.5 - away, 0.0, 1.0)[..., None]
        if shape == "RING":
            alpha *= opacity
        picture *= 1.0 - alpha
        picture += np.concatenate([color * alpha, alpha], axis=-1)


def marked_picture(picture, marks):
    """Return a picture, dimmed, below marks.

    Parameters
    ----------
    picture, marks : ndarray of shape (height, width, 4)
        Premultiplied.

    Returns
    -------
    ndarray of shape (height, width, 4)
    """
    dimmed = picture.copy()
    dimmed[..., :3] *= _DIMMED / np.maximum(picture[..., :3].max(axis=-1, keepdims=True), 1.0)
    return marks + dimmed * (1.0 - marks[..., 3:])
