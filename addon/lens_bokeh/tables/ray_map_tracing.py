"""Tracing the ray map of a lens: see `ray_map` for its contents.

For each object a fan of meridional rays first finds how far the real pupil reaches; the reach of
the map is a parabola over vergence that holds all of them. Rims do not end the rays of the map, so
that it stays smooth where another rim than the stop limits the pupil. Where rays fail the map is
extrapolated as a parabola, which is never read.
"""

from dataclasses import replace

import numpy as np

from ...errors import PrescriptionError
from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...optics.paraxial import first_order, ray_matrix
from ...optics.rays.trace import Rays, trace
from .ray_map import ENERGY, HEIGHT, SLOPE, STOP, RayMap

# Grid over s and V. Patterns of a dozen fast, wide and long lenses then agree with a direct trace
# to 75 dB in the median and 48 dB at worst, where the direct trace itself has noise at 75 dB.
PUPIL_SAMPLES = 129
VERGENCES = 17
# The search for the pupil's end: paraxial radii searched, rays, and rays between the last that
# passes and the first that does not.
_SEARCH_RADII, _SEARCH_RAYS, _SEARCH_STEPS = 2.2, 192, 16
# Factor by which the map reaches beyond the last ray that passes, so that rims lie inside of it.
_MARGIN = 1.01
# Least rays that must get through for a map.
_LEAST_RAYS = 8
# Share of the pupil by which an edge may move when a rim is left out.
_SAME_EDGE = 1.0e-4
# A limit above any share: no limit.
NO_LIMIT = 1.25


def trace_ray_map(
    configuration, wavelengths_nm, vergences, reach, *, coating=None, fresnel=False, step=None
):
    """Trace the ray map of a lens, with all its rims.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    wavelengths_nm : array_like of shape (L,)
    vergences : ndarray of shape (K,)
        From `map_vergences`.
    reach : ndarray of shape (3,)
        From `pupil_reach`.
    coating : Coating or None
        On the surfaces between glass and air; counts only with `fresnel`.
    fresnel : bool
        Whether rays lose what the surfaces reflect.
    step : callable or None
        Called after each wavelength with the share done, 0 to 1; what it raises ends the work.

    Returns
    -------
    RayMap
        `values` has one row for each surface besides the stop; `without_idle_rims` drops most.

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
    fans = [_Fan(configuration, order.enp_z, vergences, w) for w in wavelengths]
    heights = np.outer(
        np.polynomial.Polynomial(reach)(vergences), np.linspace(0.0, 1.0, PUPIL_SAMPLES)
    )
    shape = (STOP + len(configuration.surfaces), len(wavelengths), *heights.shape)
    values = np.empty(shape, np.float32)
    limits = np.empty(shape[1:3])
    paraxial = np.empty((len(wavelengths), 2, 2))
    for i, fan in enumerate(fans):
        paraxial[i] = _paraxial(configuration, order.enp_z, plane, fan.wavelength_nm)
        found, counts = fan.values(heights, plane, fresnel, coating)
        linear = np.stack([np.ones_like(vergences), vergences], axis=1) @ paraxial[i].T
        found[HEIGHT] -= linear[:, :1] * heights
        found[SLOPE] -= linear[:, 1:] * heights
        found[ENERGY] -= heights
        values[:, i] = _extended(found, counts)
        last = (counts - 1) / (PUPIL_SAMPLES - 1)
        limits[i] = np.where(counts < PUPIL_SAMPLES, last, NO_LIMIT)
        if step:
            step((i + 1) / len(wavelengths))
    reference = _paraxial(configuration, order.enp_z, plane, REFERENCE_WAVELENGTH_NM)
    return RayMap(
        wavelengths,
        vergences,
        plane,
        order.enp_z,
        radius,
        reach,
        reference,
        paraxial,
        values,
        limits,
    )


def pupil_reach(lenses, wavelengths_nm, vergences):
    """Height in the entrance pupil that no ray beyond gets through.

    Parameters
    ----------
    lenses : sequence of Configuration
        One lens at one or more settings.
    wavelengths_nm : ndarray of shape (L,)
    vergences : ndarray of shape (K,)

    Returns
    -------
    ndarray of shape (3,)
        Coefficients over vergence, lowest power first; mm.

    Raises
    ------
    PrescriptionError
        If not even rays near the axis get through.
    """
    chosen = {wavelengths_nm[i] for i in (0, len(wavelengths_nm) // 2, -1)}
    ends = []
    for lens in lenses:
        order = first_order(lens)
        for wavelength in sorted(chosen):
            fan = _Fan(lens, order.enp_z, vergences, wavelength)
            ends.append(fan.pupil_ends(order.enp_diameter / 2.0))
    return _parabola_above(vergences, np.max(ends, axis=0)) * _MARGIN


def without_idle_rims(maps):
    """Drop the rims that do not limit the pupil.

    Parameters
    ----------
    maps : sequence of RayMap
        Of one lens at one or more settings.

    Returns
    -------
    tuple of RayMap
    """
    edges = np.concatenate([_edges(each.values[STOP:]) for each in maps], axis=1)
    whole = edges.min(axis=0)
    kept = list(range(len(edges)))
    # The rims that lie farthest out are tried first; the stop always stays.
    for rim in np.argsort(-edges[1:].min(axis=1)) + 1:
        others = [each for each in kept if each != rim]
        if (edges[others].min(axis=0) - whole).max() < _SAME_EDGE:
            kept = others
    chosen = [*range(STOP), *(STOP + rim for rim in kept)]
    return tuple(replace(each, values=each.values[chosen]) for each in maps)


def _edges(levels):
    """Share at which each function first reaches 1, or a little more than 1; shape (R, L K)."""
    levels = levels.reshape(len(levels), -1, PUPIL_SAMPLES).astype(np.float64)
    outside = levels > 1.0
    index = np.where(outside.any(axis=-1), outside.argmax(axis=-1), PUPIL_SAMPLES - 1)
    after = np.take_along_axis(levels, index[..., None], -1)[..., 0]
    before = np.take_along_axis(levels, index[..., None] - 1, -1)[..., 0]
    rise = np.maximum(after - before, 1.0e-6)
    t = np.clip((1.0 - before) / rise, 0.0, _LEAST_RAYS)
    return (index - 1 + t) / (PUPIL_SAMPLES - 1)


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


def _paraxial(configuration, pupil_z, plane, wavelength_nm):
    """Coefficients of height at `plane` and of slope, each [c0, c1], per height in the pupil."""
    from_pupil = np.array([[1.0, -pupil_z], [0.0, 1.0]])
    matrix = ray_matrix(configuration, wavelength_nm) @ from_pupil
    behind = float(configuration.surfaces[-1].glass.index(wavelength_nm))
    height, slope = matrix[0], matrix[1] / behind
    return np.stack([height + (plane - configuration.vertices[-1]) * slope, slope])


def _parabola_above(places, values):
    """Coefficients of a parabola near some values and nowhere below them."""
    scale = places[-1]
    fit = np.polynomial.polynomial.polyfit(places / scale, values, 2)
    fit[0] += max(0.0, (values - np.polynomial.polynomial.polyval(places / scale, fit)).max())
    return fit / scale ** np.arange(3)


class _Fan:
    """Meridional rays of all objects at one wavelength, by their height in the entrance pupil."""

    def __init__(self, configuration, pupil_z, vergences, wavelength_nm):
        self.configuration = configuration
        self.pupil_z = pupil_z
        self.vergences = vergences
        self.wavelength_nm = wavelength_nm
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
        return trace(self.configuration, rays, self.wavelength_nm, clip=False, **options)

    def pupil_ends(self, paraxial_radius):
        """Height of the last ray of each object that gets through, shape (K,)."""
        low = np.zeros(len(self.vergences))
        high = np.full_like(low, _SEARCH_RADII * paraxial_radius)
        for count in (_SEARCH_RAYS, _SEARCH_STEPS):
            share = np.linspace(0.0, 1.0, count + 1)
            heights = low[:, None] + (high - low)[:, None] * share
            traced = self.trace(heights)
            passed = traced.passed.reshape(heights.shape)
            # What lies beyond a ray that fails does not belong to the pupil.
            passed &= np.logical_and.accumulate(traced.reached.reshape(heights.shape), axis=1)
            last = np.where(passed.any(axis=1), count - np.argmax(passed[:, ::-1], axis=1), 0)
            rows = np.arange(len(last))
            low, high = heights[rows, last], heights[rows, np.minimum(last + 1, count)]
        if not low.min() > 0.0:
            raise PrescriptionError(
                "rays near the axis do not get through the lens; check its radii and semi-diameters"
            )
        return high

    def values(self, heights, plane, fresnel, coating):
        """Trace the rays of the map.

        Returns
        -------
        values : ndarray of shape (4 + surfaces - 1, K, M)
            Whole heights, slopes and energy radii; arbitrary where rays failed.
        counts : ndarray of int, shape (K,)
            How many rays of each object did not fail, from the axis.
        """
        traced = self.trace(heights, record=True, transmission=fresnel, coating=coating)
        shape = heights.shape
        counts = _leading(traced.reached.reshape(shape))
        if counts.min() < _LEAST_RAYS:
            raise PrescriptionError(
                "rays near the axis do not get through the lens; check its radii and semi-diameters"
            )
        along = np.where(traced.reached, traced.directions[:, 2], 1.0)
        slope = (traced.directions[:, 1] / along).reshape(shape)
        height = traced.at_plane(plane)[:, 1].reshape(shape)
        secant = np.sqrt(1.0 + (heights * self.vergences[:, None]) ** 2)
        radius = heights * np.sqrt(2.0 / (secant * (1.0 + secant)))
        if fresnel:
            share = traced.transmission.reshape(shape)
            middle = (share[:, 1:] + share[:, :-1]) / 2.0
            square = np.cumsum(np.diff(radius**2, axis=1) * middle, axis=1)
            radius[:, 1:] = np.sqrt(np.maximum(square, 0.0))
        surfaces = self.configuration.surfaces
        rims = np.array([surface.semi_diameter for surface in surfaces])
        across = traced.hits[:, :, 1].reshape(-1, *shape) / rims[:, None, None]
        # Positive at the upper side of the pupil, so that all are odd functions of the height.
        across *= np.sign(across[:, :, 1])[:, :, None]
        stop = self.configuration.stop - 1
        others = np.delete(across, stop, axis=0)
        return np.concatenate([np.stack([height, slope, radius, across[stop]]), others]), counts


def _leading(good):
    """Return the number of leading true values of each row."""
    return np.argmin(np.c_[good, np.zeros(len(good), bool)], axis=1)


def _extended(values, counts):
    """Continue smooth values as parabolas beyond the rays that fail."""
    for k in np.flatnonzero(counts < PUPIL_SAMPLES):
        end = counts[k] - 1
        a, b, c = (values[:, k, end - i, None] for i in range(3))
        t = np.arange(1, PUPIL_SAMPLES - end, dtype=float)
        values[:, k, end + 1 :] = a + t * (a - b) + t * (t + 1.0) / 2.0 * (a - 2.0 * b + c)
    return values
