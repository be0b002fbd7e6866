"""Aiming rays at the stop of a lens: the real entrance pupil, not its paraxial image.

The chief ray is found from the stop: a fan of rays leaves its centre towards the scene, over nearly
a half circle, and the one that belongs to the object is bracketed, then refined by Newton's method.
That needs no idea of where the pupil is, so it works where paraxial pupils mislead: wide lenses and
fisheyes. Other rays are aimed forwards by Newton's method from the chief ray.
"""

from dataclasses import dataclass

import numpy as np

from ..glass import REFERENCE_WAVELENGTH_NM
from .trace import Rays, trace

# Angles at the stop that are tried, radians. The step only has to separate neighbouring brackets.
FAN = np.radians(np.linspace(-88.0, 88.0, 705))
# Newton's method: relative change that ends it, and how often it may step or halve a step.
TOLERANCE = 1.0e-12
MOST_STEPS = 40
# Step of the numeric derivatives, relative to the scale: the square root of double precision.
NUDGE = 1.0e-7


@dataclass(frozen=True)
class Aimed:
    """Rays of a beam that were aimed at the stop.

    Parameters
    ----------
    coordinates : ndarray of shape (N, 2)
        Of the beam (see `Beam`), mm; 0 for rays that were not found.
    found : ndarray of bool, shape (N,)
    """

    coordinates: np.ndarray
    found: np.ndarray


def chief_ray(configuration, beam, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Find the ray of a beam through the centre of the stop; rims do not count.

    Parameters
    ----------
    configuration : Configuration
    beam : Beam
    wavelength_nm : float

    Returns
    -------
    ndarray of shape (2,) or None
        Coordinates in the beam, mm; None if there is no such ray.
    """
    slopes = _bracket(configuration, beam, wavelength_nm)
    if slopes is not None:
        slopes = _refine(configuration, beam, wavelength_nm, slopes)
    if slopes is None:
        return None
    points, _, _ = _from_stop(configuration, slopes[None], wavelength_nm)
    return beam.coordinates(points)[0]


def aim(configuration, beam, stop_points, wavelength_nm=REFERENCE_WAVELENGTH_NM, chief=None):
    """Find the rays of a beam through points of the stop; rims do not count.

    Parameters
    ----------
    configuration : Configuration
    beam : Beam
    stop_points : ndarray of shape (N, 2)
        x and y on the stop surface, mm.
    wavelength_nm : float
    chief : ndarray of shape (2,) or None
        Coordinates of the chief ray if they are known.

    Returns
    -------
    Aimed
    """
    targets = np.asarray(stop_points, dtype=float).reshape(-1, 2)
    nothing = Aimed(np.zeros_like(targets), np.zeros(len(targets), dtype=bool))
    if chief is None:
        chief = chief_ray(configuration, beam, wavelength_nm)
    if chief is None or not len(targets):
        return nothing

    def height(coordinates):
        return _at_stop(configuration, beam, coordinates, wavelength_nm)

    scale = configuration.surfaces[configuration.stop - 1].semi_diameter
    # Towards each target in quarters, so that the first steps stay where Newton's method converges.
    coordinates = np.tile(chief, (len(targets), 1))
    found = np.ones(len(targets), dtype=bool)
    for share in (0.25, 0.5, 0.75, 1.0):
        coordinates, found = _newton(height, coordinates, share * targets, scale, scale)
    return Aimed(np.where(found[:, None], coordinates, 0.0), found)


def _newton(function, start, targets, scale_in, scale_out):
    """Solve function(p) = target for many 2D points at once, steps halved where they fail."""
    points = start.copy()
    values, valid = function(points)
    error = np.where(valid, np.linalg.norm(values - targets, axis=1), np.inf)
    step = _newton_step(function, points, values - targets, scale_in)
    done = error <= TOLERANCE * scale_out
    for _ in range(MOST_STEPS):
        going = np.flatnonzero(~done & np.isfinite(error))
        if not len(going):
            break
        trial = points[going] + step[going]
        values, valid = function(trial)
        left = values - targets[going]
        size = np.where(valid, np.linalg.norm(left, axis=1), np.inf)
        better = size < error[going]
        step[going[~better]] *= 0.5
        took = going[better]
        points[took], error[took] = trial[better], size[better]
        if len(took):
            step[took] = _newton_step(function, trial[better], left[better], scale_in)
        # Rounding ends it too: the next step would not change the point.
        small = np.linalg.norm(step[going], axis=1) <= TOLERANCE * scale_in
        done[going] = (error[going] <= TOLERANCE * scale_out) | small
    return points, done & (error <= 1.0e-6 * scale_out)


def _newton_step(function, points, left, scale):
    nudge = NUDGE * scale
    columns = []
    for offset in ((nudge, 0.0), (0.0, nudge)):
        ahead, valid_ahead = function(points + offset)
        behind, valid_behind = function(points - offset)
        slope = (ahead - behind) / (2.0 * nudge)
        columns.append(np.where((valid_ahead & valid_behind)[:, None], slope, 0.0))
    (a, c), (b, d) = columns[0].T, columns[1].T
    determinant = a * d - b * c
    # Where the derivative vanishes there is no step, and the point counts as not found.
    usable = np.abs(determinant) > 1.0e-30
    inverse = np.divide(1.0, determinant, out=np.zeros_like(determinant), where=usable)
    x, y = left.T
    step = np.stack([-(d * x - b * y) * inverse, -(a * y - c * x) * inverse], axis=-1)
    return np.clip(step, -1.0e3 * scale, 1.0e3 * scale)


def _at_stop(configuration, beam, coordinates, wavelength_nm):
    traced = trace(
        configuration, beam.rays(coordinates), wavelength_nm, clip=False, last=configuration.stop
    )
    return traced.points[:, :2], traced.reached


def _from_stop(configuration, slopes, wavelength_nm):
    """Trace from the stop's centre towards the scene; `slopes` are dx / dz and dy / dz there."""
    stop = configuration.stop
    directions = -np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    origins = np.zeros_like(directions)
    origins[:, 2] = configuration.vertices[stop - 1]
    rays = Rays(origins, directions)
    traced = trace(configuration, rays, wavelength_nm, clip=False, last=stop - 1, backwards=True)
    return traced.points, traced.directions, traced.reached


def _bracket(configuration, beam, wavelength_nm):
    """Slopes at the stop near those of the chief ray; None if no ray is near."""
    plane = beam.axis[:2] if np.any(beam.axis[:2]) else np.array([0.0, 1.0])
    plane = plane / np.linalg.norm(plane)
    slopes = np.tan(FAN)[:, None] * plane
    points, directions, reached = _from_stop(configuration, slopes, wavelength_nm)
    # A ray that leaves backwards through the front is no ray of an object before the lens.
    reached &= directions @ beam.axis < 0.0
    if not reached.any():
        return None
    along = np.where(reached, beam.miss(points, directions)[:, 1], np.nan)
    crossing = np.flatnonzero(reached[:-1] & reached[1:] & (along[:-1] * along[1:] <= 0.0))
    if len(crossing):
        i = crossing[np.argmin(np.abs(FAN[crossing] + FAN[crossing + 1]))]
        total = abs(along[i]) + abs(along[i + 1])
        share = abs(along[i]) / total if total > 0.0 else 0.0
        return np.tan(FAN[i] + share * (FAN[i + 1] - FAN[i])) * plane
    return slopes[np.nanargmin(np.abs(along))]


def _refine(configuration, beam, wavelength_nm, slopes):
    def miss(trial):
        points, directions, reached = _from_stop(configuration, trial, wavelength_nm)
        return beam.miss(points, directions), reached & (directions @ beam.axis < 0.0)

    points, found = _newton(miss, slopes[None], np.zeros((1, 2)), 1.0, 1.0)
    return points[0] if found[0] else None
