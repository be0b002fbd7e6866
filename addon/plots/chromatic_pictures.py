"""Small pictures of chromatic aberration for panels: a field map, a spectrum.

Made of numpy alone, fast enough to be made while a panel is drawn. Colours are sRGB encoded, pixels
RGBA, the first row at the top; colours are multiplied by alpha, as Blender draws icons.
"""

import numpy as np

# Angles for which a map that turns with theta is drawn as a curve: right, top, left.
CURVE_ANGLES = (0.0, 0.5 * np.pi, np.pi)
_CURVE_COLORS = ((0.95, 0.95, 0.95), (0.60, 0.60, 0.60), (0.38, 0.38, 0.38))
_PAPER = (0.13, 0.13, 0.13)
_GRID = (0.24, 0.24, 0.24)
_ZERO = (0.42, 0.42, 0.42)
_FRAME = (0.85, 0.85, 0.85)
# Of values above and below zero; both stay apart for the colour blind.
_POSITIVE = np.array((1.0, 0.60, 0.15))
_NEGATIVE = np.array((0.25, 0.55, 1.0))
# In pixels.
_LINE_WIDTH = 1.6
# A map that is so many times as large at its pole as in this part of the field is cut off there.
_SHOWN_QUANTILE, _POLE = 0.9, 3.0
# Wavelengths between the middles of the pixels of a spectrum that is looked up, nm.
_SPECTRUM_STEP = 1.0
# Exponent of its brightness.
_BRIGHTENING = 0.5


def map_range(field_map, samples=64):
    """Return the lowest and the highest value that a picture of a map shows.

    Parameters
    ----------
    field_map : callable
        ``field_map(t, theta)`` on arrays.
    samples : int
        Places along t and along theta.

    Returns
    -------
    tuple of 2 float
        0 lies between them. Where a pole would leave the rest too small to be seen, those of 90 %
        of the field.
    """
    t = np.linspace(0.0, 1.0, samples)
    theta = np.linspace(0.0, np.pi, samples // 2)
    values = np.asarray(field_map(t[None, :], theta[:, None]), float)
    largest = np.quantile(np.abs(values), _SHOWN_QUANTILE)
    pole = np.abs(values).max() > _POLE * largest > 0.0
    limited = np.clip(values, -largest, largest) if pole else values
    low, high = min(0.0, float(limited.min())), max(0.0, float(limited.max()))
    return (low, high) if high - low > 1e-9 else (low, low + 1.0)


def map_curve(field_map, shown, size=128):
    """Return a drawing of a map over t, from the middle of the picture to its corner.

    Parameters
    ----------
    field_map : callable
        ``field_map(t, theta)`` on arrays.
    shown : tuple of 2 float
        Lowest and highest value, of `map_range`.
    size : int
        Width and height in pixels.

    Returns
    -------
    ndarray of shape (size, size, 4)
        float32. Brighter to darker: to the right, to the top, to the left of the middle.
    """
    picture = np.empty((size, size, 3))
    picture[:] = _PAPER
    margin = 0.06 * size
    inner = size - 1.0 - 2.0 * margin
    columns = np.arange(size, dtype=float)
    rows = np.arange(size, dtype=float)[:, None]
    t = (columns - margin) / inner
    inside = (t >= 0.0) & (t <= 1.0)
    low, high = shown

    def row_of(value):
        return margin + inner * (high - value) / (high - low)

    for quarter in range(5):
        column = round(margin + 0.25 * quarter * inner)
        picture[round(margin) : round(margin + inner) + 1, column] = _GRID
    zero = round(float(row_of(0.0)))
    picture[zero, round(margin) : round(margin + inner) + 1] = _ZERO
    for angle, color in reversed(list(zip(CURVE_ANGLES, _CURVE_COLORS, strict=True))):
        values = np.asarray(field_map(np.clip(t, 0.0, 1.0), np.full(size, angle)), float)
        line = row_of(np.clip(values, low, high))
        slope = np.gradient(line)
        distance = np.abs(rows - line) / np.hypot(1.0, slope)
        cover = np.clip(0.5 + 0.5 * _LINE_WIDTH - distance, 0.0, 1.0) * inside
        picture += cover[..., None] * (np.array(color) - picture)
    return _with_alpha(picture, np.ones((size, size)))


def map_disc(field_map, shown, aspect=1.5, size=128):
    """Return a map over the field: a disc whose rim the corners of the picture touch.

    Parameters
    ----------
    field_map : callable
        ``field_map(t, theta)`` on arrays.
    shown : tuple of 2 float
        Lowest and highest value, of `map_range`; the larger of the two has the full colour.
    aspect : float
        Width over height of the picture, which is outlined.
    size : int
        Width and height in pixels.

    Returns
    -------
    ndarray of shape (size, size, 4)
        float32: orange above zero, blue below, black at zero; transparent beside the disc.
    """
    radius = 0.47 * size
    place = np.arange(size) + 0.5 - 0.5 * size
    x, y = place[None, :] / radius, -place[:, None] / radius
    distance = np.hypot(x, y)
    theta = np.arctan2(y, x) + np.zeros_like(distance)
    values = np.asarray(field_map(np.minimum(distance, 1.0), theta), float)
    share = np.clip(values / max(abs(shown[0]), abs(shown[1])), -1.0, 1.0)[..., None]
    picture = np.where(share > 0.0, share * _POSITIVE, -share * _NEGATIVE)
    half = np.array((aspect, 1.0)) / np.hypot(aspect, 1.0)
    # Distance to the rectangle's outline, in pixels.
    over_x, over_y = (np.abs(x) - half[0]) * radius, (np.abs(y) - half[1]) * radius
    outline = np.abs(np.maximum(over_x + np.zeros_like(distance), over_y))
    cover = 0.8 * np.clip(1.1 - outline, 0.0, 1.0)[..., None]
    picture += cover * (np.array(_FRAME) - picture)
    alpha = np.clip(radius * (1.0 - distance) + 1.0, 0.0, 1.0)
    return _with_alpha(picture, alpha)


def spectrum_colors(wavelength_range_nm):
    """Return the colours of a spectrum from one wavelength to another.

    Takes a second or two the first time, when a library is loaded.

    Parameters
    ----------
    wavelength_range_nm : tuple of 2 float

    Returns
    -------
    ndarray of shape (N, 3)
        Linear RGB, 1 nm apart, from 0 to 1. Dim colours are brighter than they are to the eye: else
        most of the violet and red would be black.
    """
    from ..sampling.spectrum import LINEAR_REC709, rgb_weights

    low, high = wavelength_range_nm
    colors = rgb_weights(np.arange(low, high + 0.5 * _SPECTRUM_STEP, _SPECTRUM_STEP), LINEAR_REC709)
    brightness = colors.max(axis=1, keepdims=True)
    return colors / np.maximum(brightness, 1e-12) * (brightness / brightness.max()) ** _BRIGHTENING


def encoded(linear):
    """Return linear values from 0 to 1 as sRGB encodes them."""
    return np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )


def _with_alpha(picture, alpha):
    alpha = alpha[..., None]
    return np.concatenate([picture * alpha, alpha], axis=-1).astype(np.float32)
