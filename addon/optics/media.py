"""Refractive indices of the media along a lens."""

import math
from functools import lru_cache

import numpy as np

from ..errors import PrescriptionError
from .glass import Air


def indices(configuration, wavelength_nm):
    """Return the indices in front of the lens and behind each surface.

    Parameters
    ----------
    configuration : Configuration
    wavelength_nm : float

    Returns
    -------
    tuple of float
        One more than there are surfaces; the first is 1, air in front of the lens.

    Raises
    ------
    PrescriptionError
        If the wavelength is not a positive number, or a glass has no real positive index there.
    """
    wavelength = float(wavelength_nm)
    if not (math.isfinite(wavelength) and wavelength > 0.0):
        raise PrescriptionError(f"wavelength {wavelength:g} nm must be a number greater than 0")
    found = [1.0]
    for number, surface in enumerate(configuration.surfaces, 1):
        if isinstance(surface.glass, Air):
            found.append(1.0)
            continue
        index = _index(surface.glass, wavelength)
        if not (math.isfinite(index) and index > 0.0):
            raise PrescriptionError(
                f"the glass behind surface {number} has no real refractive index at"
                f" {wavelength:g} nm; choose a wavelength where it is transparent"
            )
        found.append(index)
    return tuple(found)


# A search for a pupil traces the same lens a hundred times.
@lru_cache(maxsize=4096)
def _index(glass, wavelength_nm):
    with np.errstate(all="ignore"):
        return float(glass.index(wavelength_nm))
