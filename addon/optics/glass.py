"""Refractive index of the media in a lens over wavelength.

Wavelengths are in nm at every interface; dispersion formulas take micrometres, as their
coefficients are published. Indices are relative to air, whose index is 1.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

# Fraunhofer lines by which glasses are described, in nm.
G_LINE_NM, F_LINE_NM, D_LINE_NM, C_LINE_NM = 435.8343, 486.1327, 587.5618, 656.2725
REFERENCE_WAVELENGTH_NM = D_LINE_NM
# Where an index must be real and above 1 for a lens to be used.
CHECKED_RANGE_NM = (400.0, 700.0)


@dataclass(frozen=True)
class Air:
    """The medium around and between the glasses."""

    has_dispersion = False

    def index(self, wavelength_nm):
        """Return 1 in the shape of the wavelengths."""
        return np.ones_like(np.asarray(wavelength_nm, dtype=float))


AIR = Air()


@dataclass(frozen=True)
class ConstantGlass:
    """A glass of which only nd is known: the same index at every wavelength.

    Parameters
    ----------
    nd : float
    """

    nd: float
    has_dispersion = False

    def index(self, wavelength_nm):
        """Return the index in the shape of the wavelengths."""
        return np.full_like(np.asarray(wavelength_nm, dtype=float), self.nd)


@dataclass(frozen=True)
class AbbeGlass:
    """A glass known by index and Abbe number: ``n = A + B / L^2 + C / L^4``.

    A, B and C follow from n at the d line, from the dispersion F - C, and from the partial
    dispersion g - F of the normal line of glasses.

    Parameters
    ----------
    nd, vd : float
    dpgf : float
        Deviation of the partial dispersion from the normal line.
    """

    nd: float
    vd: float
    dpgf: float = 0.0
    has_dispersion = True

    @cached_property
    def _coefficients(self):
        main = (self.nd - 1.0) / self.vd
        partial = 0.6438 - 0.001682 * self.vd + self.dpgf
        rows = [
            _cauchy_terms(D_LINE_NM),
            _cauchy_terms(F_LINE_NM) - _cauchy_terms(C_LINE_NM),
            _cauchy_terms(G_LINE_NM) - _cauchy_terms(F_LINE_NM),
        ]
        return np.linalg.solve(np.array(rows), np.array([self.nd, main, partial * main]))

    def index(self, wavelength_nm):
        """Return the index in the shape of the wavelengths."""
        return _cauchy_terms(np.asarray(wavelength_nm, dtype=float)) @ self._coefficients


@dataclass(frozen=True)
class SellmeierGlass:
    """``n^2 = 1 + sum b_i L^2 / (L^2 - c_i)``, L in um.

    Parameters
    ----------
    b, c_um2 : tuple of float
        Of equal length, 1 to 6.
    name : str or None
        Name in the catalogue; None if the coefficients stand in the lens file.
    """

    b: tuple[float, ...]
    c_um2: tuple[float, ...]
    name: str | None = None
    has_dispersion = True

    def index(self, wavelength_nm):
        """Return the index in the shape of the wavelengths; nan where it is imaginary."""
        square = (np.asarray(wavelength_nm, dtype=float) / 1000.0) ** 2
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            terms = [b * square / (square - c) for b, c in zip(self.b, self.c_um2, strict=True)]
            return np.sqrt(1.0 + sum(terms))


@dataclass(frozen=True)
class SeriesGlass:
    """``n^2 = a0 + a1 L^2 + a2 L^-2 + a3 L^-4 + a4 L^-6 + a5 L^-8``, L in um.

    Parameters
    ----------
    coefficients : tuple of 6 float
        a0 to a5.
    """

    coefficients: tuple[float, ...]
    has_dispersion = True

    def index(self, wavelength_nm):
        """Return the index in the shape of the wavelengths; nan where it is imaginary."""
        square = (np.asarray(wavelength_nm, dtype=float) / 1000.0) ** 2
        a = self.coefficients
        with np.errstate(invalid="ignore", over="ignore"):
            inverse = 1.0 / square
            tail = inverse * (a[2] + inverse * (a[3] + inverse * (a[4] + inverse * a[5])))
            return np.sqrt(a[0] + a[1] * square + tail)


def _cauchy_terms(wavelength_nm):
    inverse = (1000.0 / np.asarray(wavelength_nm, dtype=float)) ** 2
    return np.stack([np.ones_like(inverse), inverse, inverse**2], axis=-1)


Glass = Air | ConstantGlass | AbbeGlass | SellmeierGlass | SeriesGlass
