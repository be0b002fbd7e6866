"""Dispersion of a catalogue glass or of a lens, for the chromatic aberration of a camera."""

from functools import lru_cache

import numpy as np

from ...errors import PrescriptionError
from ...optics.focal_shift import equivalent_focal_lengths
from ...sampling.chromatic import WIDEST_RANGE_NM, dispersion_of_focal_lengths, dispersion_of_glass
from .glass_catalog import catalog_glass

DEFAULT_GLASS = "N-BK7"
# About 12 nm apart: a cubic in between is off by less than 1e-6 for the glasses of lenses.
_COUNT = 40


# Memo of the name alone, and of the catalogue that comes with Aplanat.
@lru_cache(maxsize=64)
def glass_dispersion(name=DEFAULT_GLASS):
    """Return the dispersion of a single lens of a glass.

    Parameters
    ----------
    name : str
        Of the catalogue, in any case.

    Returns
    -------
    Dispersion

    Raises
    ------
    GlassNotFoundError
        If the catalogue has no such glass.
    InputError
        If it is not transparent to all visible wavelengths.
    """
    return dispersion_of_glass(catalog_glass(name))


# Memo of the lens alone: rays are traced for it.
@lru_cache(maxsize=64)
def lens_dispersion(configuration):
    """Return the dispersion of the thin lens whose focus moves over wavelength as a lens' does.

    Parameters
    ----------
    configuration : Configuration

    Returns
    -------
    Dispersion
        Over the wavelengths at which all of its glasses have an index.

    Raises
    ------
    PrescriptionError
        If the lens collects no light, or is transparent nowhere in the visible range.
    """
    wavelengths = np.linspace(*WIDEST_RANGE_NM, _COUNT)
    clear = np.ones(_COUNT, bool)
    for glass in {surface.glass for surface in configuration.surfaces}:
        index = np.asarray(glass.index(wavelengths), np.float64)
        clear &= np.isfinite(index) & (index > 0.0)
    if clear.sum() < 2:
        raise PrescriptionError(
            f"the glasses of the lens have no index between {WIDEST_RANGE_NM[0]:g} and"
            f" {WIDEST_RANGE_NM[1]:g} nm; use the dispersion of a glass instead"
        )
    wavelengths = wavelengths[clear]
    focal_lengths = equivalent_focal_lengths(configuration, wavelengths)
    return dispersion_of_focal_lengths(wavelengths, focal_lengths)
