"""The spectral equalizer: how strongly each wavelength of the dispersion counts.

A curve of weights over the wavelength, straight between its points. Whatever it is, each colour
channel is normalised afterwards, so that it changes the colours of fringes and never those of
neutral areas.
"""

from dataclasses import dataclass

import numpy as np

from ..errors import InputError


@dataclass(frozen=True)
class SpectralEqualizer:
    """Weights over wavelength.

    Parameters
    ----------
    wavelengths_nm : tuple of float
        Rising; two or more.
    weights : tuple of float
        As many, not negative, one of them above 0. Level beyond the first and the last.
    """

    wavelengths_nm: tuple[float, ...] = (380.0, 780.0)
    weights: tuple[float, ...] = (1.0, 1.0)

    def __post_init__(self):
        """Check that the curve of weights is valid."""
        places, weights = np.array(self.wavelengths_nm), np.array(self.weights)
        if len(places) < 2 or len(places) != len(weights):
            raise InputError(
                f"spectral equalizer has {len(places)} wavelengths and {len(weights)} weights;"
                " it needs two or more of each, and as many of one as of the other"
            )
        if not (np.all(np.isfinite(places)) and np.all(np.diff(places) > 0.0)):
            raise InputError("the wavelengths of the spectral equalizer must rise")
        if not (np.all(np.isfinite(weights)) and np.all(weights >= 0.0)):
            raise InputError("the weights of the spectral equalizer must not be negative")

    def __call__(self, wavelengths_nm):
        """Return the weights of wavelengths.

        Parameters
        ----------
        wavelengths_nm : array_like of shape (...)

        Returns
        -------
        ndarray of shape (...)
            Not negative.
        """
        return np.interp(wavelengths_nm, self.wavelengths_nm, self.weights)

    @property
    def is_flat(self):
        """Whether all wavelengths count alike."""
        return len(set(self.weights)) == 1 and self.weights[0] > 0.0


def band(center_nm, width_nm, edge_nm=2.0, floor=0.0):
    """Return an equalizer that lets one band through.

    Parameters
    ----------
    center_nm, width_nm : float
        Of the band at half its height.
    edge_nm : float
        Over which it rises and falls; less than the width.
    floor : float
        Weight of all the other wavelengths; that of the band is 1.

    Returns
    -------
    SpectralEqualizer
    """
    left, right = center_nm - width_nm / 2.0, center_nm + width_nm / 2.0
    half = edge_nm / 2.0
    places = (left - half, left + half, right - half, right + half)
    return SpectralEqualizer(places, (floor, 1.0, 1.0, floor))


FLAT = SpectralEqualizer()
# Name, equalizer.
EQUALIZER_PRESETS = {
    "FLAT": ("Flat", FLAT),
    "WARM": ("Warm", SpectralEqualizer((380.0, 480.0, 620.0, 780.0), (0.05, 0.1, 1.0, 1.0))),
    "COOL": ("Cool", SpectralEqualizer((380.0, 500.0, 600.0, 780.0), (1.0, 1.0, 0.1, 0.05))),
    "ENDS": (
        "Red and Violet",
        SpectralEqualizer((380.0, 450.0, 500.0, 590.0, 640.0, 780.0), (1.0, 1.0, 0.03, 0.03, 1, 1)),
    ),
    "MIDDLE": (
        "Green",
        SpectralEqualizer((380.0, 480.0, 530.0, 560.0, 620.0, 780.0), (0.05, 0.1, 1, 1, 0.1, 0.05)),
    ),
    "THREE_BANDS": (
        "Three Bands",
        SpectralEqualizer(
            (440.0, 445.0, 465.0, 470.0, 520.0, 525.0, 545.0, 550.0, 605.0, 610.0, 630.0, 635.0),
            (0.02, 1.0, 1.0, 0.02, 0.02, 1.0, 1.0, 0.02, 0.02, 1.0, 1.0, 0.02),
        ),
    ),
    "COMB": (
        "Comb",
        SpectralEqualizer(tuple(float(nm) for nm in range(400, 721, 20)), (1.0, 0.02) * 8 + (1.0,)),
    ),
}
