"""Colours of a real lens for lens samples: what other wavelengths change, traced for a few.

The lens stays as it is focused at the reference wavelength, and the picture keeps its scale: what
then changes are the aberrations B and the chief rays C of `lens_rays`, by axial and lateral colour
and spherochromatism. In between, they are polynomials of Buchdahl's chromatic coordinate, in which
the index of a glass is nearly a parabola.
"""

from dataclasses import dataclass

import numpy as np

from ...optics.glass import REFERENCE_WAVELENGTH_NM

# Wavelengths that are traced beside the reference, where the glasses have an index there: with it
# they are about the Chebyshev points of the visible spectrum in the chromatic coordinate.
_TRACED_NM = (383.0, 411.0, 478.0, 751.0)
# Steps in which the ends of the glasses' range are looked for, nm.
_STEP_NM = 5.0


@dataclass(frozen=True, eq=False)
class LensColors:
    """Changes of a lens' aberrations over wavelength.

    Parameters
    ----------
    wavelengths_nm : tuple of float
        Those traced; none where the glasses have no dispersion.
    aberrations : ndarray of shape (K, F, 4, 2, T)
        Differences of `LensRays.aberrations` from those of the reference.
    chief : ndarray of shape (K, F, 4)
        Differences of `LensRays.chief`.
    focus : ndarray of shape (K,)
        Differences of the focus on the axis, 1/m: of the vergence that the whole iris has in focus.
    """

    wavelengths_nm: tuple[float, ...]
    aberrations: np.ndarray
    chief: np.ndarray
    focus: np.ndarray

    def shares(self, wavelengths_nm):
        """Return how much of each difference wavelengths have: a polynomial, 0 at the reference.

        Parameters
        ----------
        wavelengths_nm : array_like of shape (N,)
            Beyond the traced ones, the polynomial goes on.

        Returns
        -------
        ndarray of shape (N, K)
        """
        return color_shares(self.wavelengths_nm, wavelengths_nm)


def color_shares(traced_nm, wavelengths_nm):
    """Return the shares of traced differences in those of wavelengths, as `LensColors.shares`."""
    wanted = chromatic_coordinate(np.asarray(wavelengths_nm, np.float64))
    nodes = chromatic_coordinate(np.asarray(traced_nm, np.float64))
    shares = np.ones((len(wanted), len(nodes)))
    for k, own in enumerate(nodes):
        shares[:, k] *= wanted / own
        for other in np.delete(nodes, k):
            shares[:, k] *= (wanted - other) / (own - other)
    return shares


def chromatic_coordinate(wavelengths_nm):
    """Return Buchdahl's chromatic coordinate, 0 at the reference wavelength (d line).

    References
    ----------
    Buchdahl, Optical Aberration Coefficients (1954), section 31.
    """
    change = (wavelengths_nm - REFERENCE_WAVELENGTH_NM) / 1000.0
    return change / (1.0 + 2.5 * change)


def traced_wavelengths(configuration):
    """Return the wavelengths that a lens is traced at for its colours.

    Parameters
    ----------
    configuration : Configuration

    Returns
    -------
    tuple of float
        In nm, without the reference; none where its glasses have no dispersion.
    """
    glasses = {surface.glass for surface in configuration.surfaces}
    if not any(getattr(glass, "has_dispersion", False) for glass in glasses):
        return ()
    return tuple(float(_nearest_clear(glasses, wavelength)) for wavelength in _TRACED_NM)


def _nearest_clear(glasses, wavelength):
    """Return a wavelength, moved towards the reference until all glasses have an index there."""
    toward = np.sign(REFERENCE_WAVELENGTH_NM - wavelength) * _STEP_NM
    steps = int(abs(REFERENCE_WAVELENGTH_NM - wavelength) / _STEP_NM)
    for step in range(steps):
        tried = wavelength + toward * step
        index = [float(np.asarray(glass.index(np.array([tried])))[0]) for glass in glasses]
        if np.isfinite(index).all() and min(index) > 0.0:
            return tried
    return REFERENCE_WAVELENGTH_NM + toward * -0.5


def trace_colors(fan, fields, rays, wavelengths_nm, distorted):
    """Trace what wavelengths change.

    Parameters
    ----------
    fan : RayFan
        Of the reference wavelength.
    fields : ndarray of shape (F,)
    rays : tuple of ndarray
        Aberrations and chief rays of the reference, as of `LensRays`.
    wavelengths_nm : tuple of float
    distorted : ndarray of shape (M, 2) or None
        As of `RayFan.fitted`: that of the reference, whose picture is the frame of all.

    Returns
    -------
    LensColors
    """
    reference, chief = rays
    changes, moves = np.zeros((len(wavelengths_nm), *reference.shape)), []
    for k, wavelength in enumerate(wavelengths_nm):
        other = fan.at_wavelength(wavelength)
        found = other.follow(fields)
        moved = np.zeros_like(chief)
        if found:
            count = len(found)
            seen = other.fitted(fields[:count], found, distorted)
            changes[k, :count] = seen[0] - reference[:count]
            moved[:count] = seen[1] - chief[:count]
            # Beyond the light of this wavelength, as at its end.
            changes[k, count:], moved[count:] = changes[k, count - 1], moved[count - 1]
        moves.append(moved)
    # The term that grows with the place in the iris as defocus does, for points in focus.
    ((linear,),) = np.nonzero((fan.orders == (1, 1)).all(axis=1))
    mix = np.linalg.inv(fan.slabs[:-1, None] ** np.arange(len(fan.slabs) - 1))
    at_focus = fan.focus ** np.arange(len(mix)) @ mix
    focus = changes[:, 0, :, 0, linear] @ at_focus
    moves = np.array(moves).reshape(-1, *chief.shape)
    return LensColors(tuple(wavelengths_nm), changes, moves, focus)
