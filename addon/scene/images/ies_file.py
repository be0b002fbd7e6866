"""Photometric files of lamps (IES LM-63) as pictures of their intensity.

A file has intensities in candela by vertical angle (0 downwards, 180 upwards) and horizontal angle,
of which symmetric lamps leave out what follows from the rest.
"""

import numpy as np

# Blender's watts of a candela.
_WATTS = 0.0706650768394
# Of the picture: horizontal angles, and vertical ones.
_COLUMNS, _ROWS = 720, 720


def intensities(text):
    """Read a photometric file.

    Parameters
    ----------
    text : str

    Returns
    -------
    vertical : ndarray of shape (V,)
    horizontal : ndarray of shape (H,)
        Degrees, ascending; all around, the last one 360 degrees after the first.
    values : ndarray of shape (H, V)

    Raises
    ------
    ValueError
        Where the text is no photometric file.
    """
    lines = text.replace("\r", "\n").split("\n")
    tilt = next(
        (i for i, line in enumerate(lines) if line.strip().upper().startswith("TILT")), None
    )
    if tilt is None:
        raise ValueError("no line TILT=")
    numbers = [float(word) for line in lines[tilt + 1 :] for word in line.replace(",", " ").split()]
    if lines[tilt].strip().upper().endswith("INCLUDE"):
        # How the lamp is hung, and what that does to it: two lines of as many numbers.
        numbers = numbers[2 + 2 * int(numbers[1]) :]
    if len(numbers) < 13:
        raise ValueError("it ends before its angles")
    factor = numbers[2] * numbers[10] * numbers[11]
    down, around, kind = int(numbers[3]), int(numbers[4]), int(numbers[5])
    if down < 2 or around < 1 or len(numbers) < 13 + down + around + down * around:
        raise ValueError("it has fewer numbers than it says")
    vertical = np.array(numbers[13 : 13 + down])
    horizontal = np.array(numbers[13 + down : 13 + down + around])
    values = np.array(numbers[13 + down + around :][: down * around]).reshape(around, down)
    if kind != 1:
        raise ValueError("its photometry is not of type C")
    return vertical, *_all_around(horizontal, values * factor * _WATTS)


def _all_around(horizontal, values):
    """Complete what a symmetric lamp leaves out."""
    if len(horizontal) == 1:
        return np.array([0.0, 360.0]), np.repeat(values, 2, axis=0)
    first, last = horizontal[0], horizontal[-1]
    if last - first >= 360.0 - 1e-3:
        return horizontal - first, values
    if last <= 90.0 + 1e-3:
        # A quarter, mirrored.
        horizontal = np.concatenate([horizontal, 180.0 - horizontal[-2::-1]])
        values = np.concatenate([values, values[-2::-1]])
        last = horizontal[-1]
    if last <= 180.0 + 1e-3:
        horizontal = np.concatenate([horizontal, 360.0 - horizontal[-2::-1]])
        values = np.concatenate([values, values[-2::-1]])
    elif last < 360.0 - 1e-3:
        horizontal, values = np.append(horizontal, 360.0), np.append(values, values[:1], axis=0)
    return horizontal, values


def picture(text):
    """Return a lamp's intensity in all directions as a picture.

    Parameters
    ----------
    text : str

    Returns
    -------
    ndarray of shape (720, 720, 4)
        float32, grey: columns are horizontal angles from 0 to 360 degrees, rows vertical ones from
        0 to 180, between the file's angles by cubics. 0 beyond the file's vertical angles.
    """
    vertical, horizontal, values = intensities(text)
    around = (np.arange(_COLUMNS) + 0.5) * (360.0 / _COLUMNS)
    down = (np.arange(_ROWS) + 0.5) * (180.0 / _ROWS)
    found = _between(horizontal, values, around, wraps=True)
    found = _between(vertical, found.T, down, wraps=False)
    found[(down < vertical[0] - 1e-3) | (down > vertical[-1] + 1e-3)] = 0.0
    pixels = np.ones((_ROWS, _COLUMNS, 4), np.float32)
    pixels[..., :3] = np.maximum(found, 0.0)[..., None]
    return pixels


def _between(angles, values, wanted, wraps):
    """Interpolate along the first axis by Catmull and Rom's cubic of the neighbours."""
    last = len(angles) - 1
    i = np.clip(np.searchsorted(angles, wanted, side="right") - 1, 0, last - 1)
    t = (wanted - angles[i]) / np.maximum(angles[i + 1] - angles[i], 1e-9)
    before, after = i - 1, i + 2
    if wraps:
        before, after = np.where(before < 0, last - 1, before), np.where(after > last, 1, after)
    else:
        before, after = np.maximum(before, 0), np.minimum(after, last)
    a, b, c, d = (values[k] for k in (before, i, i + 1, after))
    t = np.clip(t, 0.0, 1.0)[:, None]
    cubic = ((d + 3.0 * (b - c) - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d)) * t + (c - a)
    return 0.5 * cubic * t + b
