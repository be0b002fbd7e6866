"""Focus of a lens over wavelength, as that of a thin lens.

A lens whose sensor stands in the focus of a reference wavelength is, at another one, in focus at an
object distance that Newton's equation tells: the image lies `x' = BFL_ref - BFL` behind the rear
focal point, the object `F^2 / x'` in front of the front one. The thin lens that is in focus at the
same distance has `1/F_thin = 1/F_ref + x' / (F (F + x'))`.
"""

import numpy as np

from ..errors import PrescriptionError
from .media import indices
from .paraxial import LEAST_POWER, ray_matrix


def equivalent_focal_lengths(configuration, wavelengths_nm):
    """Return the focal lengths of the thin lens with the same shift of focus over wavelength.

    Parameters
    ----------
    configuration : Configuration
    wavelengths_nm : array_like of shape (K,)
        The last one is the reference.

    Returns
    -------
    ndarray of shape (K,)
        In mm; the last is the lens' own focal length there.

    Raises
    ------
    PrescriptionError
        If the lens does not collect light, or a glass has no index at a wavelength.
    """
    focal, back = np.array([_foci(configuration, nm) for nm in wavelengths_nm]).T
    behind = back[-1] - back
    vergence = 1.0 / focal[-1] + behind / (focal * (focal + behind))
    if not np.all(vergence > 0.0):
        raise PrescriptionError(
            "the focus of the lens moves over the wavelengths by more than its focal length;"
            " use the dispersion of a glass instead"
        )
    return 1.0 / vergence


def _foci(configuration, wavelength_nm):
    """Effective and back focal length, mm."""
    (a, _), (c, _) = ray_matrix(configuration, wavelength_nm)
    if not (np.isfinite([a, c]).all() and c < -LEAST_POWER):
        raise PrescriptionError(
            f"the lens does not collect light at {wavelength_nm:g} nm: it has no chromatic focus"
        )
    index = indices(configuration, wavelength_nm)[-1]
    return -index / c, -index * a / c
