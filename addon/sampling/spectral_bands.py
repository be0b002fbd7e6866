"""Bands of wavelengths that a highlight's disc is drawn in, a disc each (methods 8, 13).

Lens samples take the wavelengths of `sampling.spectral_samples`, one each. A disc is drawn whole,
so that its light is divided into few bands: each has the sum of its wavelengths' weights, their
mean focus and scale, and the width over which these vary, by which its disc is blurred. Neighbouring
bands' rims then join: light over place is straight from one to the next.

Bands lie closest where light is dense: for a light of ``w`` a pixel, the mean of the squared error
is least with a density that goes as ``w^(1/3)`` (Panter and Dite, Proc. IRE 39, 1951). Together
they have all the light of each channel, exactly as much as the samples.
"""

from dataclasses import dataclass

import numpy as np

from .chromatic import RGB_WAVELENGTHS_NM
from .spectral_samples import channel_density

# Rims that lie closer are one, px: the pixel filter is wider.
_SAME_RIM = 0.05
# Between rims of neighbouring bands, px; each is blurred over that much.
_STEP = 1.5


@dataclass(frozen=True)
class SpectralBand:
    """A part of the light of a highlight.

    Parameters
    ----------
    weights : tuple of 3 float
        Its share of red, green and blue.
    focal_error, lateral_strength : float
        Means over its wavelengths; see `sampling.chromatic.ChromaticAberration`.
    focal_width, lateral_width : float
        Width of the box with the variance that they have within the band.
    """

    weights: tuple[float, float, float]
    focal_error: float
    lateral_strength: float
    focal_width: float
    lateral_width: float

    @property
    def dispersion(self):
        """Focal error, lateral strength and the width of both, 4 floats."""
        return self.focal_error, self.lateral_strength, self.focal_width, self.lateral_width


def spectral_bands(aberration, axial_px, lateral_px, most):
    """Divide the light of a frame's wavelengths into bands.

    Parameters
    ----------
    aberration : ChromaticAberration
    axial_px : float
        How much larger a disc gets, at the most, by a relative change of the focal length of 1, px.
    lateral_px : float
        How far a disc moves, at the most, by a lateral strength of 1, px.
    most : int
        Bands in the spectral mode.

    Returns
    -------
    tuple of SpectralBand
        By rising wavelength; their weights sum to 1 in each channel.
    """
    if aberration.mode == "RGB":
        order = np.argsort(RGB_WAVELENGTHS_NM)
        wavelengths, light = np.array(RGB_WAVELENGTHS_NM)[order], np.eye(3)[order]
    else:
        density = channel_density(
            aberration.wavelength_range, aberration.equalizer, aberration.primaries
        )
        wavelengths, light = 0.5 * (density.edges_nm[1:] + density.edges_nm[:-1]), density.channels
    places = np.stack(
        [aberration.focal_errors(wavelengths), aberration.lateral_strengths(wavelengths)], axis=1
    )
    steps = np.abs(np.diff(places, axis=0)) @ (axial_px, lateral_px)
    if aberration.mode == "RGB":
        band = np.concatenate([[0], np.cumsum(steps > _SAME_RIM)])
    else:
        # Each wavelength has half of the way to either neighbour.
        way = 0.5 * (np.concatenate([[0.0], steps]) + np.concatenate([steps, [0.0]]))
        share = np.cbrt(light.mean(axis=1) * way**2)
        # A light that is even over a way has that way as its length.
        length = share.sum() ** 1.5
        count = int(np.clip(np.ceil(length / _STEP), 1, most)) if length > _SAME_RIM else 1
        middle = (np.cumsum(share) - 0.5 * share) / max(share.sum(), 1e-300)
        band = np.minimum((middle * count).astype(int), count - 1)
    return _joined(light, places, band)


def merged_bands(bands, most):
    """Return no more than a number of bands, by joining neighbours.

    Parameters
    ----------
    bands : sequence of SpectralBand
    most : int

    Returns
    -------
    tuple of SpectralBand
    """
    if len(bands) <= most:
        return tuple(bands)
    band = np.arange(len(bands)) * most // len(bands)
    places = np.array([(b.focal_error, b.lateral_strength) for b in bands])
    widths = np.array([(b.focal_width, b.lateral_width) for b in bands])
    return _joined(np.array([b.weights for b in bands]), places, band, widths)


def _joined(light, places, band, widths=0.0):
    """Join lines of light into bands; numbers of bands may be left out."""
    _, band = np.unique(band, return_inverse=True)
    count = band.max() + 1
    # The channels alike, so that a band is as good for one as for another.
    weight = light.mean(axis=1)
    total = np.bincount(band, weight, count)[:, None]

    def sums(values):
        return np.stack([np.bincount(band, column, count) for column in values.T], axis=1)

    middle = sums(weight[:, None] * places) / total
    variance = (places - middle[band]) ** 2 + np.square(widths) / 12.0
    spread = np.sqrt(12.0 * sums(weight[:, None] * variance) / total)
    weights = sums(light)
    weights /= weights.sum(axis=0)
    return tuple(
        SpectralBand(tuple(w), *m, *s)
        for w, m, s in zip(weights.tolist(), middle.tolist(), spread.tolist(), strict=True)
    )
