"""The appearance of a disc: everything that is a mask over the opening (methods 13).

A mask works on places of the opening in units of its radius, x to the right and y up as the camera
sees it. Whether the places come from a sprite's texels or from the traced rays of a real lens makes
no difference here.
"""

from dataclasses import dataclass, field

import numpy as np

from ...errors import InputError
from ..openings.blades import BladedIris
from ..openings.pictures import PictureIris
from . import grain as grain_model
from . import onion as onion_model
from . import vignetting_model
from .diffraction import chromatic_pattern
from .grain import Grain
from .onion import OnionRings
from .vignetting_model import Rim

_REFERENCE_NM = 587.5618


@dataclass(frozen=True)
class Diffraction:
    """Ringing along the rim of the opening.

    Parameters
    ----------
    strength : float
        0: the sharp shadow; 1: the diffraction pattern.
    wavelengths_nm : tuple of float
    weights : tuple of tuple of float
        One row for each wavelength, one column for each channel; columns sum to 1. One column
        gives a grey pattern; `addon.sampling.spectrum.rgb_weights` gives three.
    """

    strength: float = 1.0
    wavelengths_nm: tuple[float, ...] = (_REFERENCE_NM,)
    weights: tuple[tuple[float, ...], ...] = ((1.0,),)

    def __post_init__(self):
        """Check that weights and wavelengths fit."""
        if not 0.0 <= self.strength <= 1.0:
            raise InputError(f"diffraction strength is {self.strength:g}; it must be from 0 to 1")
        widths = {len(row) for row in self.weights}
        if len(self.weights) != len(self.wavelengths_nm) or len(widths) != 1:
            raise InputError(
                f"diffraction has {len(self.wavelengths_nm)} wavelengths, but weights of shape"
                f" {len(self.weights)} x {sorted(widths)}; give one row for each wavelength"
            )
        if min(self.wavelengths_nm, default=0.0) <= 0.0:
            raise InputError("diffraction needs wavelengths above 0 nm")


@dataclass(frozen=True)
class Appearance:
    """All masks that shape a disc besides the traced lens.

    Parameters
    ----------
    iris : BladedIris or PictureIris
    grain : Grain or None
    onion : OnionRings or None
    rims : tuple of Rim
        The analytic cat's eye; for lenses without pupil tables.
    diffraction : Diffraction or None
        Needs the Fresnel number of the defocus.
    anamorphic_ratio : float
        The opening's width is divided by it, as in Blender's camera.
    edge : float
        Spherical aberration of a lens without a profile: -1 a soft edge and a bright core
        (cream), 0 an even disc, 1 a bright edge (soap bubble), behind focus; the other way round
        in front of it.
    """

    iris: BladedIris | PictureIris = field(default_factory=BladedIris)
    grain: Grain | None = None
    onion: OnionRings | None = None
    rims: tuple[Rim, ...] = ()
    diffraction: Diffraction | None = None
    anamorphic_ratio: float = 1.0
    edge: float = 0.0

    def __post_init__(self):
        """Check that all values are in range."""
        if not (np.isfinite(self.anamorphic_ratio) and self.anamorphic_ratio > 0.0):
            raise InputError(
                f"anamorphic ratio is {self.anamorphic_ratio:g}; it must be greater than 0"
            )
        if not -1.0 <= self.edge <= 1.0:
            raise InputError(f"edge is {self.edge:g}; it must be from -1 to 1")

    def transmission(self, places, width, chief=(0.0, 0.0), fresnel_number=None):
        """Transmittance of all masks together.

        Parameters
        ----------
        places : ndarray of shape (..., 2)
            In units of the opening's radius, before the anamorphic ratio.
        width : float or ndarray of shape (...)
            Side of a texel there.
        chief : tuple of float
            Tangent of the chief ray's angle in x and y, towards the point as the camera sees it.
        fresnel_number : float or None
            Of the defocus at 587.6 nm; None: no diffraction.

        Returns
        -------
        ndarray of shape (..., channels)
            At least 0; 1 or 3 channels.
        """
        places = np.asarray(places, dtype=float) * (self.anamorphic_ratio, 1.0)
        width = np.asarray(width, dtype=float) * np.sqrt(self.anamorphic_ratio)
        opened = self.iris.coverage(places, width)[..., None]
        ringing = self.diffraction
        if ringing is not None and ringing.strength > 0.0 and fresnel_number:
            pattern = self._diffracted(places, float(np.min(width)), fresnel_number)
            opened = opened * (1.0 - ringing.strength) + pattern * ringing.strength
        factor = np.ones(places.shape[:-1])
        least = float(np.min(width))
        if self.grain is not None:
            factor = factor * grain_model.transmission(self.grain, places)
        if self.onion is not None:
            factor = factor * onion_model.transmission(self.onion, places, chief, least)
        if self.rims:
            factor = factor * vignetting_model.transmission(self.rims, places, chief, least)
        return opened * factor[..., None]

    def _diffracted(self, places, width, fresnel_number):
        ringing = self.diffraction
        extent = max(float(np.abs(places).max(initial=0.0)), 1.0) + 1e-6
        size = int(np.clip(np.ceil(2.0 * extent / width), 32, 512))
        pattern = chromatic_pattern(
            self.iris, fresnel_number, size, extent, ringing.wavelengths_nm, ringing.weights
        )
        at = (places + extent) * (size / (2.0 * extent)) - 0.5
        low = np.clip(np.floor(at).astype(int), 0, size - 2)
        share = np.clip(at - low, 0.0, 1.0)
        x, y, u, v = low[..., 0], low[..., 1], share[..., :1], share[..., 1:]
        lower = pattern[y, x] * (1.0 - u) + pattern[y, x + 1] * u
        upper = pattern[y + 1, x] * (1.0 - u) + pattern[y + 1, x + 1] * u
        return np.maximum(lower * (1.0 - v) + upper * v, 0.0)
