"""Light lost by reflection at a surface.

Fresnel's amplitudes for light polarised across (s) and in (p) the plane of incidence, with the
mean of both for unpolarised light; the polarisation that one surface leaves is not carried to the
next. A single layer adds up its multiple reflections, `t = t1 t2 e^(i d) / (1 + r1 r2 e^(2 i d))`
with `d = 2 pi n h cos / wavelength`. Nothing is absorbed: reflected and transmitted energy make 1.

References
----------
Born and Wolf, Principles of Optics, 1.5.2 and 1.6.4 (homogeneous film).
"""

from dataclasses import dataclass

import numpy as np

from ..errors import PrescriptionError


@dataclass(frozen=True)
class Coating:
    """A single layer, a quarter of a wavelength thick.

    Parameters
    ----------
    index : float
        Of the layer; 1.38 is magnesium fluoride, the classic one.
    wavelength_nm : float
        For which it is a quarter wave at normal incidence.
    cemented : bool
        Whether surfaces between two glasses have it too.

    Raises
    ------
    PrescriptionError
        If a number is not positive.
    """

    index: float = 1.38
    wavelength_nm: float = 550.0
    cemented: bool = False

    def __post_init__(self):
        """Refuse values that are not finite and positive."""
        for name in ("index", "wavelength_nm"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise PrescriptionError(
                    f"coating {name} is {value:g}; it must be a number greater than 0"
                )


def transmittance(cosine, before, behind, coating=None, wavelength_nm=None):
    """Share of unpolarised light that goes through a surface.

    Parameters
    ----------
    cosine : ndarray of shape (...)
        Of the angle of incidence, 0 to 1.
    before, behind : float
        Indices of the media.
    coating : Coating or None
    wavelength_nm : float or None
        Needed with a coating.

    Returns
    -------
    ndarray of shape (...)
        0 where the light is totally reflected.
    """
    return energies(cosine, before, behind, coating, wavelength_nm)[1]


def energies(cosine, before, behind, coating=None, wavelength_nm=None):
    """Reflected and transmitted shares of unpolarised light.

    Parameters
    ----------
    cosine, before, behind, coating, wavelength_nm
        As for `transmittance`.

    Returns
    -------
    reflected, transmitted : ndarray of shape (...)
        Each from its own amplitude.
    """
    first = np.clip(np.asarray(cosine, dtype=float), 0.0, 1.0)
    if before == behind:
        return np.zeros_like(first), np.ones_like(first)
    coated = coating is not None and (coating.cemented or 1.0 in (before, behind))
    if not coated:
        return _bare(first, before, behind)
    return _coated(first, before, behind, coating, wavelength_nm)


def _bare(first, before, behind):
    square = 1.0 - (before / behind) ** 2 * (1.0 - first * first)
    second = np.sqrt(np.maximum(square, 0.0))
    # Along the surface nothing enters, and 0 / 0 stands for that.
    going = (first > 0.0) & (square > 0.0)
    reflected, transmitted = np.ones_like(first), np.zeros_like(first)
    one, two = first[going], second[going]
    parts = [
        (before * one, behind * two, before * one + behind * two),
        (behind * one, before * two, behind * one + before * two),
    ]
    reflected[going] = sum(((a - b) / total) ** 2 for a, b, total in parts) / 2.0
    flux = behind * two / (before * one)
    transmitted[going] = sum((2.0 * before * one / total) ** 2 for *_, total in parts) * flux / 2.0
    return reflected, transmitted


def _coated(first, before, behind, coating, wavelength_nm):
    sine = before * np.sqrt(1.0 - first * first)
    # Complex where the layer or the glass behind it cannot carry the ray.
    media = [(n, np.sqrt(1.0 - (sine / n) ** 2 + 0j)) for n in (before, coating.index, behind)]
    phase = 0.5 * np.pi * coating.wavelength_nm / wavelength_nm * media[1][1]
    turn = np.exp(1j * phase)
    going = (first > 0.0) & (media[2][1].real > 0.0)
    reflected, transmitted = np.zeros_like(first), np.zeros_like(first)
    flux = np.ones_like(first)
    np.divide(behind * media[2][1].real, before * first, out=flux, where=going)
    for polarisation in "sp":
        r1, t1 = _amplitudes(*media[0], *media[1], polarisation)
        r2, t2 = _amplitudes(*media[1], *media[2], polarisation)
        loop = 1.0 + r1 * r2 * turn * turn
        reflected += 0.5 * np.abs((r1 + r2 * turn * turn) / loop) ** 2
        transmitted += 0.5 * np.abs(t1 * t2 * turn / loop) ** 2 * flux
    return np.where(going, reflected, 1.0), np.where(going, transmitted, 0.0)


def _amplitudes(n1, cosine1, n2, cosine2, polarisation):
    """Fresnel's r and t at a boundary, `polarisation` "s" or "p"."""
    if polarisation == "s":
        a, b = n1 * cosine1, n2 * cosine2
    else:
        a, b = n2 * cosine1, n1 * cosine2
    total = a + b
    # Both vanish along a boundary of equal media only; then nothing is reflected.
    safe = np.where(total == 0.0, 1.0, total)
    return (a - b) / safe, 2.0 * n1 * cosine1 / safe
