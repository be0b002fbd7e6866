"""Aberrations at infinity focus: longitudinal, field curvature, astigmatism, distortion, spots.

All of it comes from real rays. Positions along the axis are in mm behind the paraxial focus of the
reference wavelength. Fields and heights without a ray that gets through are left out.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..glass import REFERENCE_WAVELENGTH_NM
from ..paraxial import first_order, image_distance
from .aiming import chief_ray
from .beam import Beam
from .pupil import pupil_rays
from .trace import Rays, trace

# Distance of neighbouring rays, in entrance pupil radii: near enough for a derivative, far enough
# for its digits.
_NEIGHBOUR = 1.0e-4
# Least difference of slopes of two rays that have a focus.
_LEAST_SLOPE = 1.0e-12
# Planes of the search for the best focus, and number of its refinements.
_FOCUS_PLANES, _FOCUS_SEARCHES = 81, 3


@dataclass(frozen=True)
class AxialFocus:
    """Longitudinal aberration: where rays parallel to the axis cross it.

    Parameters
    ----------
    rho : ndarray of shape (N,)
        Heights in the entrance pupil, in units of its radius, of the rays that get through.
    shift : ndarray of shape (N,)
        mm behind the paraxial focus of the reference wavelength.
    """

    rho: np.ndarray
    shift: np.ndarray


@dataclass(frozen=True)
class FieldCurves:
    """Image height and foci of narrow beams around the chief ray, over the field.

    Parameters
    ----------
    field_deg : ndarray of shape (N,)
        Of the fields that have a chief ray; rims do not count.
    height : ndarray of shape (N,)
        In the paraxial image plane, mm; positive for a positive field.
    distortion : ndarray of shape (N,)
        Share by which the height exceeds that of the lens' projection.
    tangential, sagittal : ndarray of shape (N,)
        Foci in and across the plane of field and axis, mm behind the paraxial focus.
    """

    field_deg: np.ndarray
    height: np.ndarray
    distortion: np.ndarray
    tangential: np.ndarray
    sagittal: np.ndarray


def axial_focus(configuration, rho, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Trace rays parallel to the axis to where they cross it.

    Parameters
    ----------
    configuration : Configuration
    rho : sequence of float
        Heights in the paraxial entrance pupil in units of its radius; 0 is the paraxial limit.
    wavelength_nm : float

    Returns
    -------
    AxialFocus
        Without the rays that are blocked or fail.

    Raises
    ------
    PrescriptionError
        If the lens has no power or no entrance pupil, or a glass has no index at the wavelength.
    """
    rho = np.asarray(rho, dtype=float)
    radius = first_order(configuration).enp_diameter / 2.0
    focus = paraxial_focus(configuration)
    origins = np.zeros((len(rho), 3))
    origins[:, 1] = rho * radius
    directions = np.broadcast_to([0.0, 0.0, 1.0], origins.shape)
    traced = trace(configuration, Rays(origins, directions), wavelength_nm)
    y, m, n = traced.points[:, 1], traced.directions[:, 1], traced.directions[:, 2]
    crosses = traced.passed & (np.abs(m) > _LEAST_SLOPE)
    z = np.zeros(len(rho))
    np.divide(-y * n, m, out=z, where=crosses)
    z += traced.points[:, 2]
    paraxial = rho == 0.0
    limit = configuration.vertices[-1] + image_distance(configuration, math.inf, wavelength_nm)
    z[paraxial] = limit
    found = crosses | paraxial
    return AxialFocus(rho[found], z[found] - focus)


def field_curves(configuration, fields_deg, projection="rectilinear"):
    """Trace chief rays and their neighbours at the reference wavelength.

    Parameters
    ----------
    configuration : Configuration
    fields_deg : sequence of float
        Field 0 has no distortion: 0.
    projection : {"rectilinear", "fisheye"}
        Against which distortion is measured: height f tan(field), or f times field.

    Returns
    -------
    FieldCurves

    Raises
    ------
    PrescriptionError
        If the lens has no power or no entrance pupil.
    """
    values = first_order(configuration)
    nudge = _NEIGHBOUR * values.enp_diameter / 2.0
    focus = paraxial_focus(configuration)
    rows = []
    for field_deg in fields_deg:
        beam = Beam.from_infinity(field_deg)
        chief = chief_ray(configuration, beam)
        if chief is None:
            continue
        steps = np.array([(0.0, 0.0), (0.0, nudge), (0.0, -nudge), (nudge, 0.0), (-nudge, 0.0)])
        traced = trace(configuration, beam.rays(chief + steps), REFERENCE_WAVELENGTH_NM, clip=False)
        if not traced.reached.all():
            continue
        x, y = traced.at_plane(focus).T
        slopes = traced.directions[:, :2] / traced.directions[:, 2:]
        tangential = _crossing(y[1:3], slopes[1:3, 1])
        sagittal = _crossing(x[3:5], slopes[3:5, 0])
        if tangential is None or sagittal is None:
            continue
        ideal = values.efl * _projected(math.radians(field_deg), projection)
        distortion = y[0] / ideal - 1.0 if ideal else 0.0
        rows.append((field_deg, y[0], distortion, tangential, sagittal))
    columns = np.array(rows, dtype=float).reshape(-1, 5).T
    return FieldCurves(*columns)


def spot(configuration, field_deg, z, wavelength_nm=REFERENCE_WAVELENGTH_NM, grid=41):
    """Trace a beam that fills the real entrance pupil to a plane.

    Parameters
    ----------
    configuration : Configuration
    field_deg : float
    z : float
        Of the plane, mm from the vertex of surface 1.
    wavelength_nm : float
    grid : int
        Rays along each side of the pupil's box.

    Returns
    -------
    ndarray of shape (N, 2)
        x and y in mm; empty if nothing gets through.

    Raises
    ------
    PrescriptionError
        If the field angle is not below 90 degrees, or a glass has no index at the wavelength.
    """
    bundle = pupil_rays(configuration, field_deg, grid, wavelength_nm).rays
    traced = trace(configuration, bundle, wavelength_nm)
    return traced.at_plane(z)[traced.passed]


def best_focus(configuration, grid=41):
    """Plane in which half of the axial beam is in the smallest circle, at the reference wavelength.

    Rays that go far astray do not count, as they do in a root mean square.

    Parameters
    ----------
    configuration : Configuration
    grid : int
        Rays along each side of the pupil.

    Returns
    -------
    float
        z in mm; the paraxial focus if no ray gets through.
    """
    bundle = pupil_rays(configuration, 0.0, grid).rays
    traced = trace(configuration, bundle, REFERENCE_WAVELENGTH_NM)
    passed = traced.passed
    slopes = traced.directions[passed, :2] / traced.directions[passed, 2:]
    plane = paraxial_focus(configuration)
    steep = np.sum(slopes**2, axis=1)
    if not np.any(steep > _LEAST_SLOPE**2):
        return plane
    heights = traced.at_plane(plane)[passed]
    # Where each ray is nearest to the axis: the best plane lies among these.
    waists = -np.sum(heights * slopes, axis=1) / np.maximum(steep, _LEAST_SLOPE**2)
    waists = waists[steep > _LEAST_SLOPE**2]
    low, high = float(waists.min()), float(waists.max())
    for _ in range(_FOCUS_SEARCHES):
        shifts = np.linspace(low, high, _FOCUS_PLANES)
        sizes = [np.median(np.sum((heights + s * slopes) ** 2, axis=1)) for s in shifts]
        best, step = float(shifts[int(np.argmin(sizes))]), (high - low) / (_FOCUS_PLANES - 1)
        low, high = best - step, best + step
    return plane + best


def paraxial_focus(configuration):
    """Return the z of the paraxial focus of infinity at the reference wavelength, in mm."""
    return configuration.vertices[-1] + image_distance(configuration, math.inf)


def _projected(angle, projection):
    return angle if projection == "fisheye" else math.tan(angle)


def _crossing(heights, slopes):
    """Distance behind the plane of their heights at which two rays cross."""
    difference = slopes[0] - slopes[1]
    if abs(difference) < _LEAST_SLOPE:
        return None
    return float((heights[1] - heights[0]) / difference)
