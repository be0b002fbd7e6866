"""Colour of wavelengths: CIE 1931 colour-matching functions into linear RGB.

Wavelengths are in nm. Negative lobes are clipped at zero before the weights are normalised, so
that light only ever adds; a spectrum that is flat over the wavelengths becomes white.
"""

import functools
import sys
import warnings

import numpy as np

from ..errors import InputError

LINEAR_REC709 = "ITU-R BT.709"
# Range of the wavelengths of a chromatic lens table, nm: the eye is nearly blind beyond.
SPECTRUM_RANGE_NM = (440.0, 680.0)
SPECTRUM_COUNT = 25
# Names of scene-linear spaces in Blender's configuration, and what colour-science calls them.
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
        Name of a colour space in colour-science, or a matrix from XYZ to linear RGB.

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
        Name of a colour space in colour-science, or the matrix itself.

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
    """Return the colour space of colour-science that is a working space of Blender's.

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


# Memo of nothing: the import of a module.
@functools.cache
def _colour():
    # Where scipy is not installed, colour-science says so in a warning and leaves a stand-in among
    # the modules, which others would take for scipy. Nothing that is used here needs it.
    before = {name for name in sys.modules if name.partition(".")[0] == "scipy"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import colour
    if not getattr(sys.modules.get("scipy"), "__file__", None):
        for name in [name for name in sys.modules if name.partition(".")[0] == "scipy"]:
            if name not in before:
                del sys.modules[name]
    return colour


# Memo of nothing but a table of the module.
@functools.cache
def _observer():
    functions = _colour().MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    wavelengths = np.array(functions.wavelengths, dtype=np.float64)
    return wavelengths, np.array(functions.values, dtype=np.float64)


# Memo of the name alone, and of tables of the module.
@functools.cache
def _matrix(name):
    spaces = _colour().RGB_COLOURSPACES
    if name not in spaces:
        raise InputError(
            f"colour space '{name}' is not known; "
            f"use '{LINEAR_REC709}', 'ITU-R BT.2020' or 'ACEScg'"
        )
    return np.array(spaces[name].matrix_XYZ_to_RGB, dtype=np.float64)
