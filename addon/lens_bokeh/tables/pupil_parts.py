"""Serialisation of pupil tables: named pictures and text attributes, for files.

Every picture has shape (height, width, channels), float32: the fields of a table stand one above
the other, the first one at row 0.
"""

import numpy as np

from ...errors import InputError
from .pupil_tables import CHANNELS, CHROMATIC_CHANNELS, CURVES, PupilTables

PREFIX = "pupil"
# Part of the names of cached files: goes up when channels or their meaning change.
LAYOUT = 2
_NUMBERS = ("curve_step", "field_step", "sensor", "stop_radius", "f_number", "half_field_deg")
_CHANNELS = {"curves": CURVES, "tables": CHANNELS, "chromatic": CHROMATIC_CHANNELS}


def pack(tables):
    """Turn tables into pictures and words.

    Parameters
    ----------
    tables : PupilTables

    Returns
    -------
    words : dict of str to str
        Numbers with all their digits.
    pictures : dict of str to ndarray of float32, shape (height, width, channels)
    """
    words = {f"{PREFIX}.{name}": repr(float(getattr(tables, name))) for name in _NUMBERS}
    words[f"{PREFIX}.wavelengths_nm"] = " ".join(repr(each) for each in tables.wavelengths_nm)
    words[f"{PREFIX}.fields"] = str(len(tables.tables))
    for name, channels in _CHANNELS.items():
        words[f"{PREFIX}.{name}.channels"] = " ".join(channels)
    grid = tables.tables.shape[1]
    pictures = {
        f"{PREFIX}.curves": tables.curves[:, None].astype(np.float32),
        f"{PREFIX}.tables": tables.tables.reshape(-1, grid, len(CHANNELS)),
    }
    if len(tables.chromatic):
        pictures[f"{PREFIX}.chromatic"] = tables.chromatic.reshape(
            -1, grid, len(CHROMATIC_CHANNELS)
        )
    return words, pictures


def unpack(words, pictures):
    """Turn pictures and words back into tables.

    Parameters
    ----------
    words : mapping of str to str
    pictures : mapping of str to ndarray
        As `pack` gave them; others are ignored.

    Returns
    -------
    PupilTables

    Raises
    ------
    InputError
        If something is missing or does not fit.
    """
    try:
        numbers = {name: float(words[f"{PREFIX}.{name}"]) for name in _NUMBERS}
        wavelengths = tuple(float(word) for word in words[f"{PREFIX}.wavelengths_nm"].split())
        fields = int(words[f"{PREFIX}.fields"])
        curves = np.asarray(pictures[f"{PREFIX}.curves"], dtype=float)
        flat = np.asarray(pictures[f"{PREFIX}.tables"], dtype=np.float32)
        grid = flat.shape[1]
        tables = flat.reshape(fields, grid, grid, len(CHANNELS))
        chromatic = np.zeros((0, fields, grid, grid, len(CHROMATIC_CHANNELS)), dtype=np.float32)
        if len(wavelengths) > 1:
            further = np.asarray(pictures[f"{PREFIX}.chromatic"], dtype=np.float32)
            chromatic = further.reshape(len(wavelengths) - 1, *chromatic.shape[1:])
        curves = curves.reshape(len(curves), len(CURVES))
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(
            f"pupil tables are incomplete or damaged ({error}); make them again"
        ) from (error)
    if not all(np.isfinite(each).all() for each in (curves, tables, chromatic)):
        raise InputError("pupil tables contain numbers that are not finite; make them again")
    return PupilTables(
        curves=curves,
        tables=tables,
        chromatic=chromatic,
        wavelengths_nm=wavelengths,
        **numbers,
    )
