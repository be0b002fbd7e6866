"""Chromatic aberration of the thin lens: focus and magnification by wavelength (methods 8).

With the focal length `F(lambda)`, that of the reference wavelength `F_hat`, and the focus distance
`d_hat`, the plane in focus at a wavelength is (Jeong's dissertation, equation 4.5)

    d_f(lambda) = F_hat d_hat F(lambda) / (F_hat d_hat - F(lambda) d_hat + F(lambda) F_hat),

which is `1/d_f = 1/d_hat + 1/F(lambda) - 1/F_hat`. Over the field, `F(lambda)` becomes
`lerp(F(lambda), F_hat, A(t, theta))` (4.7), and objects are scaled about the axis by
`m = 1 + k_l (lambda_hat - lambda) L(t, theta)` (4.8), here with the wavelengths in micrometres.
The reference is the longest wavelength in use or `focus_nm`. Wavelengths are in nm, lengths in m.
"""

from dataclasses import dataclass, field

import numpy as np

from ..errors import InputError
from .equalizer import FLAT, SpectralEqualizer
from .field_maps import STANDARD, FieldMap

RGB_WAVELENGTHS_NM = (650.0, 510.0, 475.0)
SPECTRAL_RANGE_NM = (380.0, 780.0)
# Range of the colour-matching functions, nm; the settings' range is clamped to it.
WIDEST_RANGE_NM = (360.0, 830.0)
# No focal length shrinks below this share, and no object either: they would turn inside out.
LEAST_FOCAL_SHARE = 0.05
LEAST_SCALE = 0.05

# Far focus planes magnify an error of the focal length a thousandfold; this leaves 2e-12 of it.
_GLASS_STEP_NM = 1.0


@dataclass(frozen=True)
class Dispersion:
    """Focal length over wavelength, relative to that of the longest wavelength.

    Parameters
    ----------
    wavelengths_nm : tuple of float
        Rising; two or more.
    focal_ratio : tuple of float
        `F(lambda) / F(longest)`; positive.
    """

    wavelengths_nm: tuple[float, ...]
    focal_ratio: tuple[float, ...]

    def __post_init__(self):
        """Check that the curve of focal lengths is valid."""
        places, ratios = np.array(self.wavelengths_nm), np.array(self.focal_ratio)
        if len(places) < 2 or len(places) != len(ratios) or not np.all(np.diff(places) > 0.0):
            raise InputError("a dispersion needs two or more rising wavelengths, each with a ratio")
        if not (np.all(np.isfinite(ratios)) and np.all(ratios > 0.0)):
            raise InputError("the focal lengths of a dispersion must be positive")

    def ratio(self, wavelengths_nm, reference_nm=None):
        """Return focal lengths over that of the reference.

        Parameters
        ----------
        wavelengths_nm : array_like of shape (...)
            Beyond the known ones the focal length stays as it is.
        reference_nm : float or None
            None: the longest known wavelength.

        Returns
        -------
        ndarray of shape (...)
        """
        ratio = self._interpolate(wavelengths_nm)
        if reference_nm is None:
            return ratio / self.focal_ratio[-1]
        return ratio / self._interpolate(reference_nm)

    @property
    def disperses(self):
        """Whether the focal length depends on the wavelength at all."""
        return float(np.ptp(self.focal_ratio)) > 1.0e-9

    def _interpolate(self, wavelengths_nm):
        # Cubic through the four nearest points.
        places, values = np.array(self.wavelengths_nm), np.array(self.focal_ratio)
        x = np.clip(np.asarray(wavelengths_nm, np.float64), places[0], places[-1])
        points = min(4, len(places))
        first = np.searchsorted(places, x, side="right") - points // 2
        first = np.clip(first, 0, len(places) - points)
        index = first[..., None] + np.arange(points)
        nodes = places[index]
        basis = np.ones(nodes.shape)
        for k in range(points):
            for j in range(points):
                if j != k:
                    basis[..., k] *= (x - nodes[..., j]) / (nodes[..., k] - nodes[..., j])
        return (basis * values[index]).sum(axis=-1)


def dispersion_of_focal_lengths(wavelengths_nm, focal_lengths):
    """Return the dispersion of a lens of known focal lengths.

    Parameters
    ----------
    wavelengths_nm : array_like of shape (K,)
        Rising.
    focal_lengths : array_like of shape (K,)
        Of one sign, in any unit.

    Returns
    -------
    Dispersion
    """
    lengths = np.asarray(focal_lengths, np.float64)
    ratio = lengths / lengths[-1]
    return Dispersion(tuple(map(float, wavelengths_nm)), tuple(map(float, ratio)))


def dispersion_of_glass(glass):
    """Return the dispersion of a single thin lens of a glass: `1/F` goes as `n - 1`.

    Parameters
    ----------
    glass : object
        With ``index(wavelength_nm)``, as in `addon.optics.glass`.

    Returns
    -------
    Dispersion
        Over `WIDEST_RANGE_NM`.

    Raises
    ------
    InputError
        If the glass is not transparent there.
    """
    count = round((WIDEST_RANGE_NM[1] - WIDEST_RANGE_NM[0]) / _GLASS_STEP_NM) + 1
    wavelengths = np.linspace(*WIDEST_RANGE_NM, count)
    power = np.asarray(glass.index(wavelengths), np.float64) - 1.0
    if not np.all(power > 0.0):
        raise InputError(
            "the glass has no real refractive index above 1 over"
            f" {WIDEST_RANGE_NM[0]:g} to {WIDEST_RANGE_NM[1]:g} nm; choose another one"
        )
    return dispersion_of_focal_lengths(wavelengths, 1.0 / power)


@dataclass(frozen=True)
class ChromaticAberration:
    """Chromatic aberration of a camera.

    Parameters
    ----------
    mode : {'RGB', 'SPECTRAL'}
        Three wavelengths, one for each channel, or the whole range.
    axial : float
        Factor of the dispersion of the focal length: 1 is the glass' or lens' own.
    lateral : float
        `k_l` in 1/um: 0.05 makes the shortest of 400 nm of wavelengths 2 % larger where the map
        is 1.
    dispersion : Dispersion
    focal_length : float
        `F_hat`, in m; positive.
    axial_map, lateral_map : FieldMap
        `A` and `L`. Where `A` is 0 the axial aberration is whole, where it is 1 there is none.
    wavelength_range : tuple of 2 float
        In nm; of the spectral mode.
    equalizer : SpectralEqualizer
        Of the spectral mode.
    primaries : str
        Working space of the picture; see `spectrum.primaries_of`.
    focus_nm : float or None
        The reference wavelength; None: the longest in use.
    of_lens : bool
        The dispersion is the camera's real lens'. Samples that see through it have its traced
        colours, without maps; `axial` and `lateral` are factors of what wavelengths differ by.
    """

    mode: str
    axial: float
    lateral: float
    dispersion: Dispersion
    focal_length: float
    axial_map: FieldMap = STANDARD
    lateral_map: FieldMap = STANDARD
    wavelength_range: tuple[float, float] = SPECTRAL_RANGE_NM
    equalizer: SpectralEqualizer = field(default=FLAT)
    primaries: str = "ITU-R BT.709"
    focus_nm: float | None = None
    of_lens: bool = False

    def __post_init__(self):
        """Check that the parameters can form a picture."""
        if self.mode not in {"RGB", "SPECTRAL"}:
            raise InputError(f"chromatic mode '{self.mode}' is not known; use RGB or SPECTRAL")
        if not (np.isfinite(self.axial) and np.isfinite(self.lateral)):
            raise InputError("the strengths of the chromatic aberration must be finite")
        if not (np.isfinite(self.focal_length) and self.focal_length > 0.0):
            raise InputError(
                f"focal length of the chromatic aberration is {self.focal_length:g} m;"
                " it must be greater than 0"
            )
        low, high = self.wavelength_range
        if not WIDEST_RANGE_NM[0] <= low < high <= WIDEST_RANGE_NM[1]:
            raise InputError(
                f"wavelength range is {low:g} to {high:g} nm; it must rise inside"
                f" {WIDEST_RANGE_NM[0]:g} to {WIDEST_RANGE_NM[1]:g} nm"
            )

    @property
    def reference_nm(self):
        """`lambda_hat`: that of the focus, else the longest wavelength in use."""
        if self.focus_nm is not None:
            return self.focus_nm
        return max(RGB_WAVELENGTHS_NM) if self.mode == "RGB" else self.wavelength_range[1]

    @property
    def extremes_nm(self):
        """The shortest and the longest wavelength in use."""
        if self.mode == "RGB":
            return min(RGB_WAVELENGTHS_NM), max(RGB_WAVELENGTHS_NM)
        return self.wavelength_range

    def focal_errors(self, wavelengths_nm):
        """Return the relative differences of focal lengths on the axis from `F_hat`.

        Parameters
        ----------
        wavelengths_nm : array_like of shape (...)

        Returns
        -------
        ndarray of shape (...)
            `axial (F(lambda) / F_hat - 1)`.
        """
        ratio = self.dispersion.ratio(wavelengths_nm, self.reference_nm)
        return self.axial * (ratio - 1.0)

    def lateral_strengths(self, wavelengths_nm):
        """Return the relative magnification of objects where the lateral map is 1.

        `wavelengths_nm` has any shape, and so has `k_l (lambda_hat - lambda)`.
        """
        return self.lateral * (self.reference_nm - np.asarray(wavelengths_nm, np.float64)) * 1.0e-3

    def focal_lengths(self, wavelengths_nm, t=0.0, theta=0.0):
        """Return focal lengths over the field, equation (4.7).

        Parameters
        ----------
        wavelengths_nm, t, theta : array_like, broadcast
            In nm, as in `field_maps`, and in radians.

        Returns
        -------
        ndarray
            In m; not below `LEAST_FOCAL_SHARE` of the reference's.
        """
        kept = 1.0 - self.axial_map(t, theta)
        return self.focal_length * np.maximum(
            1.0 + self.focal_errors(wavelengths_nm) * kept, LEAST_FOCAL_SHARE
        )

    def focus_distances(self, focus, wavelengths_nm, t=0.0, theta=0.0):
        """Return the distances in focus over wavelength and field.

        Parameters
        ----------
        focus : float
            At the reference wavelength, in m.
        wavelengths_nm, t, theta : array_like, broadcast

        Returns
        -------
        ndarray
            In m; as `chromatic_focus`.
        """
        at = self.focal_lengths(wavelengths_nm, t, theta)
        return chromatic_focus(focus, self.focal_length, at)

    def lateral_scales(self, wavelengths_nm, t=0.0, theta=0.0):
        """Return the scale of objects about the axis over wavelength and field.

        Parameters
        ----------
        wavelengths_nm, t, theta : array_like, broadcast

        Returns
        -------
        ndarray
        """
        field_value = self.lateral_map(t, theta)
        return lateral_scale(wavelengths_nm, self.reference_nm, self.lateral, field_value)

    def problems(self):
        """Return warnings about strengths that cannot be met everywhere in the picture.

        Returns
        -------
        tuple of str
            One sentence each.
        """
        found = []
        spectral = np.linspace(*self.wavelength_range, 41)
        wavelengths = np.array(RGB_WAVELENGTHS_NM) if self.mode == "RGB" else spectral
        t, theta = np.linspace(0.0, 1.0, 33)[:, None], np.linspace(-np.pi, np.pi, 9)
        places = (wavelengths[:, None, None], t, theta)
        if np.any(self.lateral_scales(*places) <= LEAST_SCALE):
            found.append(
                "its lateral strength would turn some colors inside out; they are drawn at"
                f" {LEAST_SCALE:g} of their size"
            )
        return tuple(found)


def chromatic_focus(focus, focal_length, focal_length_at):
    """Distance in focus at a wavelength, equation (4.5).

    Parameters
    ----------
    focus : array_like, broadcast
        Distance in focus at the reference wavelength, in m; positive.
    focal_length : array_like, broadcast
        At the reference wavelength, in m; positive.
    focal_length_at : array_like, broadcast
        At the wavelength, in m; positive.

    Returns
    -------
    ndarray
        In m. Negative where nothing in front of the lens is in focus (the condition of equation
        4.6): as of a lens that is focused beyond infinity, the blur goes on as it went.

    References
    ----------
    Jeong, Rendering of defocus blur and bokeh, equations 4.5 and 4.6.
    """
    focus, longest, here = np.broadcast_arrays(
        *(np.asarray(value, np.float64) for value in (focus, focal_length, focal_length_at))
    )
    with np.errstate(divide="ignore"):
        return longest * focus * here / (longest * focus - here * focus + here * longest)


def lateral_scale(wavelengths_nm, reference_nm, strength, field_value):
    """Scale of objects about the axis, equation (4.8).

    Parameters
    ----------
    wavelengths_nm, reference_nm : array_like, broadcast
        In nm.
    strength : array_like, broadcast
        `k_l`, in 1/um.
    field_value : array_like, broadcast
        `L(t, theta)`.

    Returns
    -------
    ndarray
        Not below `LEAST_SCALE`.

    References
    ----------
    Jeong, Rendering of defocus blur and bokeh, equation 4.8.
    """
    difference = (np.asarray(reference_nm, np.float64) - wavelengths_nm) * 1.0e-3
    return np.maximum(1.0 + strength * difference * field_value, LEAST_SCALE)
