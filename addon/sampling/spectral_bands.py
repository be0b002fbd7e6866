"""Bands of wavelengths for chromatic bokeh: a highlight has a disc for each band (methods 8, 13).

Lens samples take the wavelengths of `sampling.spectral_samples`, one each. Discs are whole
pictures, so the light of a highlight is divided into few bands: each has the sum of its
wavelengths' weights, their mean focus and scale, and the width over which these vary, by which its
disc is blurred. The rims of neighbouring bands then join: between them the light is interpolated
linearly.

Bands are densest where the light is: for a light of ``w`` a pixel, the mean squared error is least
with a density of bands that goes as ``w^(1/3)`` (Panter and Dite, Proc. IRE 39, 1951). Together
they have all the light of each channel, exactly as much as the samples.

How far the colours spread differs over the field; each highlight takes as many bands as it needs:
the level for its own `spectral_length`.
"""

from dataclasses import dataclass

import numpy as np

from .chromatic import RGB_WAVELENGTHS_NM
from .spectral_samples import channel_density

# Rims closer than this are drawn as one, px: the pixel filter is wider.
_SAME_RIM = 0.05
# Distance between the rims of neighbouring bands, px; each is blurred over that much. With 16
# bands, the summed light inside any radius is within 2 %, however far the colours spread.
_STEP = 1.5
# Wavelengths among which the middle one is found.
_AMONG = 512


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


@dataclass(frozen=True)
class BandLevel:
    """Bands for highlights whose colours spread by a range of lengths.

    Parameters
    ----------
    bands : tuple of SpectralBand
        By rising wavelength; their weights sum to 1 in each channel.
    least, most : float
        Bounds of the `spectral_length`, px: at least, and less than.
    """

    bands: tuple[SpectralBand, ...]
    least: float
    most: float


def spectral_length(aberration, axial_px, lateral_px):
    """Return the length over which the rims of all wavelengths are spread.

    It is the length over which an even light would need as many bands.

    Parameters
    ----------
    aberration : ChromaticAberration
    axial_px : float
        Change of a disc's radius by a relative change of the focal length of 1, px.
    lateral_px : float
        Shift of a disc by a lateral strength of 1, px.

    Returns
    -------
    float
        In px.
    """
    light, places = _lines(aberration)
    return float(_dense(light, places, axial_px, lateral_px).sum() ** 1.5)


def spectral_bands(aberration, axial_px, lateral_px, count):
    """Divide the light of a frame's wavelengths into bands.

    Parameters
    ----------
    aberration : ChromaticAberration
    axial_px, lateral_px : float
        See `spectral_length`; their ratio counts.
    count : int
        Of bands; the RGB mode has no more than three.

    Returns
    -------
    tuple of SpectralBand
    """
    light, places = _lines(aberration)
    return _joined(light, places, _numbers(light, places, axial_px, lateral_px, count))


def bands_needed(light, places, axial_px, lateral_px, most):
    """Divide light into as many bands as its colours spread, and at most so many.

    Parameters
    ----------
    light : ndarray of shape (M, 3)
        As of `light_lines`.
    places : ndarray of shape (M, 2)
        Axial and lateral differences of the lines, in any unit.
    axial_px, lateral_px : float
        Pixels of a unit.
    most : int

    Returns
    -------
    ndarray of int, shape (M,)
        The band of each line, from 0, without gaps.
    """
    length = float(_dense(light, places, axial_px, lateral_px).sum() ** 1.5)
    count = 1 if length < _SAME_RIM else min(max(2, int(np.ceil(length / _STEP))), most)
    if count > 1 and len(light) <= len(RGB_WAVELENGTHS_NM):
        count = len(light)
    _, numbers = np.unique(
        _numbers(light, places, axial_px, lateral_px, count), return_inverse=True
    )
    return numbers


def band_levels(aberration, axial_px, lateral_px, most):
    """Return levels with ever more bands, for colours that spread little or much.

    Parameters
    ----------
    aberration : ChromaticAberration
    axial_px, lateral_px : float
        See `spectral_length`, where colours spread most.
    most : int
        Bands of the last level.

    Returns
    -------
    tuple of BandLevel
        By rising length; the last level has no upper bound.
    """
    length = spectral_length(aberration, axial_px, lateral_px)
    if aberration.mode == "RGB":
        # The first level with several bands begins as soon as the rims can be told apart.
        counts, ends = [1, len(RGB_WAVELENGTHS_NM)], [_SAME_RIM]
    else:
        counts = [1 << n for n in range(most.bit_length())]
        ends = [_SAME_RIM, *(count * _STEP for count in counts[1:-1])]
    levels = np.searchsorted(ends, length, side="right") + 1
    starts, ends = [0.0, *ends][:levels], [*ends[: levels - 1], np.inf]
    return tuple(
        BandLevel(spectral_bands(aberration, axial_px, lateral_px, count), low, high)
        for count, low, high in zip(counts, starts, ends, strict=False)
    )


def middle_wavelength(aberration):
    """Return the wavelength whose focus is the mean of all the light's: 1/F is their mean.

    Parameters
    ----------
    aberration : ChromaticAberration
        Of a glass, whose focal length rises with the wavelength.

    Returns
    -------
    float
        In nm.
    """
    wavelengths, light = light_lines(aberration)
    ratio = aberration.dispersion.ratio
    mean = float(light.mean(axis=1) @ (1.0 / ratio(wavelengths)))
    among = np.linspace(*aberration.extremes_nm, _AMONG)[::-1]
    return float(np.interp(mean, 1.0 / ratio(among), among))


def light_lines(aberration):
    """Return the spectral lines of an aberration.

    Parameters
    ----------
    aberration : ChromaticAberration

    Returns
    -------
    wavelengths_nm : ndarray of shape (M,)
        Rising.
    light : ndarray of shape (M, 3)
        Share of red, green and blue of each; each column sums to 1.
    """
    if aberration.mode == "RGB":
        order = np.argsort(RGB_WAVELENGTHS_NM)
        return np.array(RGB_WAVELENGTHS_NM)[order], np.eye(3)[order]
    density = channel_density(
        aberration.wavelength_range, aberration.equalizer, aberration.primaries
    )
    return 0.5 * (density.edges_nm[1:] + density.edges_nm[:-1]), density.channels


def _lines(aberration):
    """Return spectral lines: weights (M, 3), and focal errors and lateral strengths (M, 2)."""
    wavelengths, light = light_lines(aberration)
    places = aberration.focal_errors(wavelengths), aberration.lateral_strengths(wavelengths)
    return light, np.stack(places, axis=1)


def _numbers(light, places, axial_px, lateral_px, count):
    """Return the number of each line's band; with gaps where lines are far apart."""
    if len(light) <= count:
        return np.arange(len(light))
    share = _dense(light, places, axial_px, lateral_px)
    middle = (np.cumsum(share) - 0.5 * share) / max(share.sum(), 1e-300)
    return np.minimum((middle * count).astype(int), count - 1)


def _dense(light, places, axial_px, lateral_px):
    """Return each line's share of the bands: by cube roots of its light and squared length."""
    steps = np.abs(np.diff(places, axis=0)) @ (axial_px, lateral_px)
    # The length of a line: half of the distance to either neighbour.
    way = 0.5 * (np.concatenate([[0.0], steps]) + np.concatenate([steps, [0.0]]))
    return np.cbrt(light.mean(axis=1) * way**2)


def _joined(light, places, band):
    """Join spectral lines into bands; `band` has the number of each line, with gaps allowed."""
    _, band = np.unique(band, return_inverse=True)
    count = band.max() + 1
    # The channels alike, so that a band is as good for one as for another.
    weight = light.mean(axis=1)
    total = np.bincount(band, weight, count)[:, None]

    def sums(values):
        return np.stack([np.bincount(band, column, count) for column in values.T], axis=1)

    middle = sums(weight[:, None] * places) / total
    variance = sums(weight[:, None] * (places - middle[band]) ** 2) / total
    weights = sums(light)
    weights /= weights.sum(axis=0)
    return tuple(
        SpectralBand(tuple(w), *m, *s)
        for w, m, s in zip(
            weights.tolist(), middle.tolist(), np.sqrt(12.0 * variance).tolist(), strict=True
        )
    )
