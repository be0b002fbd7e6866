"""Near-field diffraction of the iris: ringing along the rim of a defocused point.

A point out of focus is the Fresnel diffraction pattern of the opening. In units of the radius of
the geometric shadow it depends on the Fresnel number of the defocus alone:

``U(u) = N integral g(x) exp(i pi N |x - u|^2) d^2x``, ``N = a^2 |1/z - 1/z0| / lambda``

with a the radius of the exit pupil, z0 its distance to the focus and z that to the sensor. This is
the fractional Fourier transform of g of the angle phi, cot phi = N l^2, seen on the scale
1 / cos phi, for any choice of the unit of length l (Pellat-Finet): order 0 is the geometric shadow
(N large), order 1 the Fraunhofer pattern (N small), whose first zero for a round opening is at
u = 0.61 / N.

Only intensities are wanted, so that of the three chirps of the transform the last one is never
applied. What is left has two forms, and each samples its chirp well on its side of phi = 45
degrees: a chirp followed by a Fourier transform, here as a product with a matrix, which gives any
sampling of the result (phi above); and a convolution with a chirp by FFT (phi below).

References
----------
Pellat-Finet, Fresnel diffraction and the fractional-order Fourier transform, Optics Letters 19(18),
1994. Ozaktas et al., Digital computation of the fractional Fourier transform, IEEE TSP 44(9), 1996.
"""

from functools import lru_cache

import numpy as np

from ...errors import InputError
from ..openings.masks import iris_mask

# The FFT form spans this times the radius of the opening on either side. Copies of the opening
# then stand two radii away from the rim, where the diffracted amplitude is below 1 % for N > 100.
_WINDOW = 2.0
_WINDOW_SAMPLES = 1600
# phi = 45 degrees for the unit of length that makes window and band equal: l^2 = width^2 / samples.
_LARGEST_NUMBER_OF_MATRIX = _WINDOW_SAMPLES / (2.0 * _WINDOW) ** 2
_FEWEST_SAMPLES = 256


def fresnel_number(pupil_radius, focus_distance, sensor_distance, wavelength_nm):
    """Fresnel number of a defocus.

    Parameters
    ----------
    pupil_radius : float
        Radius of the exit pupil, mm.
    focus_distance, sensor_distance : float
        From the exit pupil to the point's image and to the sensor, mm.
    wavelength_nm : float

    Returns
    -------
    float
        0 in focus.
    """
    curvature = abs(1.0 / sensor_distance - 1.0 / focus_distance)
    return pupil_radius**2 * curvature / (wavelength_nm * 1e-6)


def pattern_extent(number):
    """Half the width of a picture that holds the pattern, in units of the shadow's radius.

    Parameters
    ----------
    number : float
        Fresnel number.

    Returns
    -------
    float
        The rim, two fringes beyond it, and the first five rings of the Fraunhofer pattern.
    """
    return 1.0 + 2.0 * np.sqrt(0.5 / number) + 2.6 / number


def diffraction_pattern(iris, number, size, extent=None):
    """Intensity behind an opening for one wavelength.

    Parameters
    ----------
    iris : BladedIris or PictureIris
    number : float
        Fresnel number, > 0.
    size : int
        Texels along a side.
    extent : float or None
        The pattern spans -extent to extent in units of the radius of the geometric shadow. None:
        `pattern_extent`.

    Returns
    -------
    ndarray of shape (size, size)
        Texel means; 1 is the intensity in the shadow of a clear opening without diffraction.
        Over the whole plane the mean energy equals that of the opening.

    Raises
    ------
    InputError
        If the Fresnel number is not positive and finite.
    """
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(f"Fresnel number is {number:g}; it must be greater than 0 and finite")
    extent = pattern_extent(number) if extent is None else extent
    if number > _LARGEST_NUMBER_OF_MATRIX and extent <= _WINDOW:
        return _by_convolution(iris, number, size, extent)
    return _by_matrix(iris, number, size, extent)


def chromatic_pattern(iris, number, size, extent, wavelengths_nm, weights, reference_nm=587.5618):
    """Sum of the patterns of several wavelengths.

    Parameters
    ----------
    iris : BladedIris or PictureIris
    number : float
        Fresnel number at `reference_nm`; it goes with 1 / wavelength.
    size : int
    extent : float
        As in `diffraction_pattern`.
    wavelengths_nm : sequence of float
    weights : ndarray of shape (wavelengths, channels)
        Share of each wavelength in each channel.
    reference_nm : float

    Returns
    -------
    ndarray of shape (size, size, channels)
    """
    total = 0.0
    for wavelength, weight in zip(wavelengths_nm, np.asarray(weights, dtype=float), strict=True):
        one = diffraction_pattern(iris, number * reference_nm / wavelength, size, extent)
        total = total + one[..., None] * weight
    return total


def _by_matrix(iris, number, size, extent):
    # The phase may turn by half a turn at most from sample to sample at the farthest point, and
    # the finest fringes (1 / N wide at the far rim) are averaged over a texel.
    samples = int(np.ceil(max(_FEWEST_SAMPLES, 4.4 * number * (1.0 + extent))))
    parts = int(np.clip(np.ceil(4.0 * number * extent / size), 2, 8))
    amplitude = _amplitude(iris, samples)
    step = 2.0 / samples
    x = (np.arange(samples) + 0.5) * step - 1.0
    u = (np.arange(parts * size) + 0.5) * (2.0 * extent / (parts * size)) - extent
    kernel = np.exp(1j * np.pi * number * (x - u[:, None]) ** 2) * (np.sqrt(number) * step)
    intensity = np.abs((kernel @ amplitude) @ kernel.T) ** 2
    return intensity.reshape(size, parts, size, parts).mean(axis=(1, 3))


# All wavelengths and all defocuses of an opening use the same mask.
@lru_cache(maxsize=4)
def _amplitude(iris, samples):
    return iris_mask(iris.amplitude(), samples)


# Memo of the iris alone.
@lru_cache(maxsize=2)
def _spectrum(iris):
    # Single precision: its rounding is far below the ripple of the window.
    opening = iris.amplitude()
    amplitude = np.zeros((_WINDOW_SAMPLES,) * 2, np.complex64)
    # Nothing passes beyond the corners of a picture's square.
    inner = int(np.ceil(_WINDOW_SAMPLES * np.sqrt(0.5) / _WINDOW)) * 2
    reach = _WINDOW * inner / _WINDOW_SAMPLES
    edge = (_WINDOW_SAMPLES - inner) // 2
    amplitude[edge : edge + inner, edge : edge + inner] = iris_mask(opening, inner, reach, 2)
    return np.fft.fft2(amplitude)


def _by_convolution(iris, number, size, extent):
    frequency = np.fft.fftfreq(_WINDOW_SAMPLES, 2.0 * _WINDOW / _WINDOW_SAMPLES)
    chirp = np.exp(-1j * np.pi / number * frequency**2).astype(np.complex64)
    # Only the rows and columns that are asked for are finished.
    half = min(int(np.ceil(extent * _WINDOW_SAMPLES / (2.0 * _WINDOW))) + 1, _WINDOW_SAMPLES // 2)
    inner = slice(_WINDOW_SAMPLES // 2 - half, _WINDOW_SAMPLES // 2 + half)
    wave = np.fft.ifft(_spectrum(iris) * chirp[:, None], axis=0)[inner]
    wave *= chirp
    wave = np.fft.ifft(wave, axis=1)[:, inner]
    intensity = wave.real.astype(float) ** 2 + wave.imag.astype(float) ** 2
    return _resampled(intensity, size, extent)


def _resampled(intensity, size, extent):
    """Exact means over texels of a picture whose samples are squares of constant value."""
    samples = intensity.shape[0]
    pitch = 2.0 * _WINDOW / _WINDOW_SAMPLES
    edges = np.linspace(-extent, extent, size + 1) / pitch + samples / 2.0
    edges = np.clip(edges, 0.0, samples)
    sums = np.zeros((samples + 1, samples))
    np.cumsum(intensity, axis=0, out=sums[1:])
    rows = _at_edges(sums, edges)
    columns = np.zeros((samples + 1, size))
    np.cumsum(np.diff(rows, axis=0).T, axis=0, out=columns[1:])
    return np.diff(_at_edges(columns, edges), axis=0).T * (0.5 * size * pitch / extent) ** 2


def _at_edges(sums, edges):
    low = np.minimum(edges.astype(int), sums.shape[0] - 2)
    share = (edges - low)[:, None]
    return sums[low] * (1.0 - share) + sums[low + 1] * share
