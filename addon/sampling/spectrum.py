"""Colour of wavelengths: CIE 1931 colour-matching functions into linear RGB.

Wavelengths are in nm. Negative lobes are clipped at zero before the weights are normalised, so
that light only ever adds; a spectrum that is flat over the wavelengths becomes white.
"""

import functools
import json
from pathlib import Path

import numpy as np

from ..errors import InputError

LINEAR_REC709 = "ITU-R BT.709"
# Range of the wavelengths of a chromatic lens table, nm: the eye is nearly blind beyond.
SPECTRUM_RANGE_NM = (440.0, 680.0)
SPECTRUM_COUNT = 25
# Chromaticities of red, green, blue and white (x, y), as the standards have them: ITU-R BT.709-6,
# ITU-R BT.2020-2, and SMPTE ST 2065-1 with the primaries AP1 of ACES S-2014-004.
_D65 = (0.3127, 0.3290)
_SPACES = {
    LINEAR_REC709: ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), _D65),
    "ITU-R BT.2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), _D65),
    "ACEScg": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), (0.32168, 0.33767)),
}
# Names of scene-linear spaces in Blender's configuration.
_WORKING_SPACES = {
    "Linear Rec.709": LINEAR_REC709,
    "Linear Rec.2020": "ITU-R BT.2020",
    "ACEScg": "ACEScg",
}


def spectrum_wavelengths(count=SPECTRUM_COUNT):
    """Wavelengths spread evenly over the visible spectrum of a lens table, both ends included.

    Parameters
    ----------
    count : int

    Returns
    -------
    ndarray of shape (count,)
        In nm.
    """
    return np.linspace(*SPECTRUM_RANGE_NM, count)


def color_matching(wavelengths_nm):
    """CIE 1931 2 degree colour-matching functions.

    Parameters
    ----------
    wavelengths_nm : array_like of shape (N,)

    Returns
    -------
    ndarray of shape (N, 3)
        x, y, z; zero outside 360 to 830 nm. Linear between the published values, which are 1 nm
        apart.
    """
    wavelengths = np.asarray(wavelengths_nm, dtype=np.float64)
    known, values = _observer()
    columns = [np.interp(wavelengths, known, column, 0.0, 0.0) for column in values.T]
    return np.stack(columns, axis=-1)


def rgb_weights(wavelengths_nm, primaries=LINEAR_REC709):
    """Share of each wavelength in each colour channel.

    Parameters
    ----------
    wavelengths_nm : array_like of shape (N,)
    primaries : str or array_like of shape (3, 3)
        "ITU-R BT.709", "ITU-R BT.2020" or "ACEScg", or a matrix from XYZ to linear RGB.

    Returns
    -------
    ndarray of shape (N, 3)
        Not negative; each column sums to 1, so that equal energy at every wavelength is white.

    Raises
    ------
    InputError
        If the colour space is not known, or the wavelengths give a channel no light at all.

    References
    ----------
    CIE 015:2018, Colorimetry (1931 standard observer).
    """
    linear = np.maximum(color_matching(wavelengths_nm) @ xyz_to_rgb(primaries).T, 0.0)
    total = linear.sum(axis=0)
    if not np.all(total > 0.0):
        channel = ["red", "green", "blue"][int(np.argmin(total))]
        raise InputError(
            f"the wavelengths {np.min(wavelengths_nm):g} to {np.max(wavelengths_nm):g} nm "
            f"have no {channel} in them; take some of the whole range from 440 to 680 nm"
        )
    return linear / total


def xyz_to_rgb(primaries):
    """Matrix from XYZ to linear RGB.

    Parameters
    ----------
    primaries : str or array_like of shape (3, 3)
        As of `rgb_weights`.

    Returns
    -------
    ndarray of shape (3, 3)

    Raises
    ------
    InputError
        If the colour space is not known.
    """
    return _matrix(primaries) if isinstance(primaries, str) else np.asarray(primaries, float)


def primaries_of(working_space):
    """Return the primaries of a working space of Blender's.

    Parameters
    ----------
    working_space : str
        As Blender names it.

    Returns
    -------
    str or None
        None for a space that is not known.
    """
    return _WORKING_SPACES.get(working_space)


# Memo of nothing but a file of the extension.
@functools.cache
def _observer():
    path = Path(__file__).with_name("tables") / "standard_observer.json"
    table = json.loads(path.read_text(encoding="utf-8"))
    values = np.array(table["xyz"])
    return table["first_nm"] + table["step_nm"] * np.arange(len(values)), values


# Memo of the name alone.
@functools.cache
def _matrix(name):
    if name not in _SPACES:
        raise InputError(
            f"colour space '{name}' is not known; use {', '.join(map(repr, _SPACES))} or a matrix"
        )
    red, green, blue, white = (_xyz(*place) for place in _SPACES[name])
    primaries = np.column_stack([red, green, blue])
    # Red, green and blue of 1 are white.
    return np.linalg.inv(primaries * np.linalg.solve(primaries, white))


def _xyz(x, y):
    return np.array([x / y, 1.0, (1.0 - x - y) / y])
