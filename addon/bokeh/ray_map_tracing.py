"""Tracing the ray map of a lens: see `ray_map` for what it tells.

For each wavelength and object a fan of meridional rays finds how far the real pupil reaches; a few
steps of Newton's method then aim rays at evenly spaced heights in the stop. Rims do not end these
rays, so that the map stays smooth where another rim than the stop limits the pupil; where each rim
would block is noted instead. Where rays fail the map goes straight on, and nothing reads it there.
"""

import numpy as np

from ..errors import PrescriptionError
from ..optics.glass import REFERENCE_WAVELENGTH_NM
from ..optics.paraxial import first_order, ray_matrix
from ..optics.trace import Rays, trace
from .ray_map import RayMap

# Grid over sigma and V: with cubic interpolation the error stays below a thousandth of the
# aberration itself, measured on fast, wide and long lenses.
STOP_SAMPLES = 129
VERGENCES = 17
# Rays that search the real pupil.
_FAN = 97
# A limit that no stop fraction reaches.
NO_LIMIT = 4.0
# Fewer rays than this say nothing about a lens.
_LEAST_RAYS = 8


def trace_ray_map(
    configuration, wavelengths_nm, *, vergences=None, coating=None, fresnel=False, step=None
):
    """Trace the ray map of a lens.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    wavelengths_nm : array_like of shape (L,)
    vergences : ndarray or None
        None: those of `map_vergences`.
    coating : Coating or None
        On the surfaces between glass and air; counts only with `fresnel`.
    fresnel : bool
        Whether rays lose what the surfaces reflect.
    step : callable or None
        Called after each wavelength with the share done, 0 to 1; what it raises ends the work.

    Returns
    -------
    RayMap

    Raises
    ------
    PrescriptionError
        If the lens has no power or no finite entrance pupil, or if not even rays near the axis
        get through.
    """
    wavelengths = np.atleast_1d(np.asarray(wavelengths_nm, dtype=np.float64))
    order = first_order(configuration)
    plane = configuration.vertices[-1] + order.bfl
    radius = order.enp_diameter / 2.0
    if vergences is None:
        vergences = map_vergences(configuration, order)
    residuals = np.empty((3, len(wavelengths), len(vergences), STOP_SAMPLES), np.float32)
    limits = np.empty(
        (len(wavelengths), len(vergences), len(configuration.surfaces) + 1), np.float32
    )
    paraxial = np.empty((len(wavelengths), 2, 2))
    for i, wavelength in enumerate(wavelengths):
        fan = _Fan(configuration, order.enp_z, vergences, wavelength)
        heights = fan.pupil_heights(radius)
        paraxial[i] = _paraxial(configuration, order.enp_z, radius, plane, wavelength)
        found, limits[i] = fan.final(heights, plane, fresnel, coating)
        sigma = np.linspace(0.0, 1.0, STOP_SAMPLES)
        linear = np.stack([np.ones_like(vergences), vergences], axis=1) @ paraxial[i].T
        found[0] -= linear[:, :1] * sigma
        found[1] -= linear[:, 1:] * sigma
        found[2] -= radius * sigma
        residuals[:, i] = _extended(found, limits[i, :, -1])
        if step:
            step((i + 1) / len(wavelengths))
    reference = _paraxial(configuration, order.enp_z, radius, plane, REFERENCE_WAVELENGTH_NM)
    return RayMap(
        wavelengths,
        vergences,
        plane,
        order.enp_z,
        reference,
        paraxial,
        radius,
        residuals,
        limits,
    )


def nearest_object(configuration, order):
    """Return the z of the nearest object that a ray map covers; nearer ones are extrapolated.

    Parameters
    ----------
    configuration : Configuration
    order : FirstOrder

    Returns
    -------
    float
        mm from surface 1: half again the focal length before H, and a focal length or the front
        lens' radius before surface 1.
    """
    room = max(order.efl, configuration.surfaces[0].semi_diameter)
    return min(order.h - 1.5 * order.efl, -room, order.enp_z - room)


def map_vergences(configuration, order):
    """Vergences of the objects whose rays are traced.

    Parameters
    ----------
    configuration : Configuration
    order : FirstOrder

    Returns
    -------
    ndarray of shape (VERGENCES,)
        1/mm, rising from 0.
    """
    nearest = 1.0 / (order.enp_z - nearest_object(configuration, order))
    # Denser towards infinity, where scenes are.
    return nearest * np.linspace(0.0, 1.0, VERGENCES) ** 2


def _paraxial(configuration, pupil_z, pupil_radius, plane, wavelength_nm):
    """Coefficients of height at `plane` and slope, per sigma: [[c0, c1], [c0, c1]]."""
    from_pupil = np.array([[1.0, -pupil_z], [0.0, 1.0]])
    matrix = ray_matrix(configuration, wavelength_nm) @ from_pupil * pupil_radius
    behind = float(configuration.surfaces[-1].glass.index(wavelength_nm))
    height, slope = matrix[0], matrix[1] / behind
    return np.stack([height + (plane - configuration.vertices[-1]) * slope, slope])


class _Fan:
    """Meridional rays of all objects at one wavelength, by their height in the entrance pupil."""

    def __init__(self, configuration, pupil_z, vergences, wavelength_nm):
        self.configuration = configuration
        self.pupil_z = pupil_z
        self.vergences = vergences
        self.wavelength_nm = wavelength_nm
        self.stop = configuration.stop
        self.stop_radius = configuration.surfaces[self.stop - 1].semi_diameter
        # Rays start on this plane: before the whole front surface, and behind every object.
        nearest = pupil_z - 1.0 / vergences[-1]
        self.start = max(nearest, -configuration.surfaces[0].semi_diameter)

    def trace(self, heights, **options):
        """Trace rays of shape (K, n); returns the traced rays, flat."""
        slopes = heights * self.vergences[:, None]
        origins = np.zeros((heights.size, 3))
        origins[:, 1] = (heights + (self.start - self.pupil_z) * slopes).ravel()
        origins[:, 2] = self.start
        directions = np.zeros_like(origins)
        directions[:, 1] = slopes.ravel()
        directions[:, 2] = 1.0
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        rays = Rays(origins, directions)
        return trace(
            self.configuration, rays, self.wavelength_nm, clip=False, record=True, **options
        )

    def stop_fractions(self, heights):
        """Sigma of rays, and which of them found their way to the stop; shape (K, n)."""
        traced = self.trace(heights, last=self.stop)
        across = np.abs(traced.hits[self.stop - 1, :, 1]).reshape(heights.shape)
        good = traced.reached.reshape(heights.shape)
        return across / self.stop_radius, good

    def pupil_heights(self, paraxial_radius):
        """Heights in the pupil plane of rays with evenly spaced sigma, shape (K, M)."""
        targets = np.linspace(0.0, 1.0, STOP_SAMPLES)
        reach = np.full(len(self.vergences), 1.25 * paraxial_radius)
        for _ in range(6):
            heights = reach[:, None] * np.linspace(0.0, 1.0, _FAN)
            sigma, good = self.stop_fractions(heights)
            # Beyond the first failure or turning back, rays do not belong to the pupil.
            rising = np.diff(sigma, axis=1, prepend=-1.0) > 0.0
            ends = np.argmin(np.c_[good & rising, np.zeros(len(good), bool)], axis=1) - 1
            largest = sigma[np.arange(len(ends)), ends]
            short = (largest < 1.0) & (ends == _FAN - 1)
            if not short.any():
                break
            reach[short] *= 1.5
        if ends.min() < _LEAST_RAYS:
            raise PrescriptionError(
                "rays near the axis do not get through the lens; check its radii and semi-diameters"
            )
        found = np.empty((len(ends), STOP_SAMPLES))
        slopes = np.empty_like(found)
        for k, end in enumerate(ends):
            known, places = sigma[k, : end + 1], heights[k, : end + 1]
            found[k] = np.interp(targets, known, places)
            slopes[k] = np.interp(targets, known, np.gradient(places, known))
        for _ in range(2):
            sigma, good = self.stop_fractions(found)
            found += np.where(good, (targets - sigma) * slopes, 0.0)
        # Rays beyond the last good one are not real; `final` tells them from the others.
        return np.where(targets <= largest[:, None], found, np.nan)

    def final(self, heights, plane, fresnel, coating):
        """Trace the rays of the map.

        Returns
        -------
        values : ndarray of shape (3, K, M)
            Height, slope, effective pupil radius; arbitrary beyond the last limit.
        limits : ndarray of shape (K, S + 1)
        """
        real = np.isfinite(heights)
        heights = np.where(real, heights, 0.0)
        traced = self.trace(heights, transmission=fresnel, coating=coating)
        shape = heights.shape
        real &= traced.reached.reshape(shape)
        direction = np.where(traced.reached, traced.directions[:, 2], 1.0)
        slope = (traced.directions[:, 1] / direction).reshape(shape)
        height = traced.at_plane(plane)[:, 1].reshape(shape)
        secant = np.sqrt(1.0 + (heights * self.vergences[:, None]) ** 2)
        radius = heights * np.sqrt(2.0 / (secant * (1.0 + secant)))
        if fresnel:
            share = traced.transmission.reshape(shape)
            middle = (share[:, 1:] + share[:, :-1]) / 2.0
            square = np.cumsum(np.diff(radius**2, axis=1) * middle, axis=1)
            radius[:, 1:] = np.sqrt(np.maximum(square, 0.0))
        across = np.abs(traced.hits[:, :, 1]).reshape(-1, *shape)
        return np.stack([height, slope, radius]), self._limits(across, real)

    def _limits(self, across, real):
        sigma = np.linspace(0.0, 1.0, STOP_SAMPLES)
        counts = np.argmin(np.c_[real, np.zeros(len(real), bool)], axis=1)
        if counts.min() < _LEAST_RAYS:
            raise PrescriptionError(
                "rays near the axis do not get through the lens; check its radii and semi-diameters"
            )
        limits = np.full((len(real), len(across) + 1), NO_LIMIT)
        limits[counts < STOP_SAMPLES, -1] = sigma[counts[counts < STOP_SAMPLES] - 1]
        for k, count in enumerate(counts):
            for s, surface in enumerate(self.configuration.surfaces):
                if s == self.stop - 1:
                    limits[k, s] = 1.0
                    continue
                rim, hits = surface.semi_diameter, across[s, k, :count]
                outside = int(np.argmax(hits > rim)) if (hits > rim).any() else count - 1
                low, high = hits[outside - 1], hits[outside]
                if high > low:
                    crossing = sigma[outside - 1] + (rim - low) / (high - low) * sigma[1]
                    limits[k, s] = min(max(crossing, 0.0), NO_LIMIT)
        return limits


def _extended(values, last):
    """Continue smooth values straight on beyond the sigma where rays fail."""
    sigma = np.linspace(0.0, 1.0, STOP_SAMPLES)
    for k in np.flatnonzero(last < 1.0):
        end = int(np.searchsorted(sigma, last[k] + 1.0e-6)) - 1
        beyond = np.arange(1, STOP_SAMPLES - end)
        slope = values[:, k, end] - values[:, k, end - 1]
        values[:, k, end + 1 :] = values[:, k, end, None] + slope[:, None] * beyond
    return values
