"""Rays of scene points through given places of a lens' stop.

A point is given by its field h, the tangent of its angle to the axis, and its vergence V, one over
its distance from the plane of the entrance pupil: it lies at ``h / V`` above the axis. The ray from
it through a place x of that plane has the slope ``x V - h``, at infinity, too. The place for which
the ray passes the stop at a target is found by Newton's method, field by field, each beginning
where the last one ended. A field that is one number lies in the yz plane. Lengths in mm.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...optics.rays.trace import Rays, trace

_STEPS = 12
_TOLERANCE = 1e-9
# Step of the derivatives, in units of the stop's radius.
_NUDGE = 1e-4


@dataclass(frozen=True, eq=False)
class StopRays:
    """Rays of points of one field through places of the stop.

    Parameters
    ----------
    places : ndarray of shape (N, 2)
        On the plane of the entrance pupil, mm.
    landing : ndarray of shape (N, 2)
        On the sensor, mm.
    rims : ndarray of shape (S, N)
        1 - (radius / semi-diameter)^2 where the rays meet each surface.
    found : ndarray of bool, shape (N,)
        Whether there is such a ray; numbers of the others mean nothing.
    """

    places: np.ndarray
    landing: np.ndarray
    rims: np.ndarray
    found: np.ndarray


class StopAim:
    """Aims rays at the stop of a lens.

    Parameters
    ----------
    configuration : Configuration
        A focused lens, its stop as far open as it is used.
    pupil : float
        z of the paraxial entrance pupil.
    pupil_radius : float
        Of the stop's paraxial image, positive; negative if the stop is seen upside down.
    wavelength_nm : float
    """

    def __init__(self, configuration, pupil, pupil_radius, wavelength_nm):
        self._configuration = configuration
        self._pupil = pupil
        self.pupil_radius = pupil_radius
        # Its place among the surfaces.
        self.stop = configuration.stop - 1
        self._wavelength = wavelength_nm
        self._radii = np.array([surface.semi_diameter for surface in configuration.surfaces])

    def at_wavelength(self, wavelength_nm):
        """Return the aim for another wavelength: pupil and places of the stop are the same."""
        return StopAim(self._configuration, self._pupil, self.pupil_radius, wavelength_nm)

    def rays(self, field, vergences, targets, start):
        """Find rays.

        Parameters
        ----------
        field : float or ndarray of shape (2,)
        vergences : ndarray of shape (N,)
            1/mm.
        targets : ndarray of shape (N, 2)
            Places in the stop, in units of its radius.
        start : ndarray of shape (N, 2)
            Places on the pupil to begin from, mm.

        Returns
        -------
        StopRays
        """
        places, found = self._solve(field, vergences, targets, start)
        rays = self.rays_of(field, vergences, places)
        return replace(rays, found=found & rays.found)

    def rays_of(self, field, vergences, places):
        """Trace rays through given places of the pupil.

        Parameters
        ----------
        field : float or ndarray of shape (2,)
        vergences : ndarray of shape (N,)
        places : ndarray of shape (N, 2)
            mm.

        Returns
        -------
        StopRays
        """
        traced = self._traced(_seen(field), vergences, places, record=True)
        rims = 1.0 - np.sum(traced.hits[..., :2] ** 2, axis=-1) / self._radii[:, None] ** 2
        landing = traced.at_plane(self._configuration.sensor)
        return StopRays(places, landing, rims, traced.reached)

    def through(self, field, vergences, places):
        """Trace rays through places of the pupil.

        Parameters
        ----------
        field : float or ndarray of shape (2,)
        vergences : ndarray of shape (N,)
        places : ndarray of shape (N, 2)
            mm.

        Returns
        -------
        stops, landing : ndarray of shape (N, 2)
            In units of the stop's radius, and mm on the sensor; 0 where a ray fails.
        """
        traced = self._traced(_seen(field), vergences, places, record=True)
        stops = traced.hits[self.stop, :, :2] / self._radii[self.stop]
        landing = traced.at_plane(self._configuration.sensor)
        return np.where(traced.reached[:, None], stops, 0.0), landing

    def throughput(self, field, vergences, places):
        """Light of rays of one radiance, for even places of the iris and of the sensor.

        Etendue is what an optical system keeps: the light of a cell of the iris that comes to a
        cell of the sensor is ``cos^4(a) |dx/dq| / |ds/dh|``, a the angle of the ray to the axis,
        ``|dx/dq|`` the area of the pupil's plane for one of the iris at the same point, ``|ds/dh|``
        that of the sensor for one of the field at the same place of the iris.

        Parameters
        ----------
        field : float or ndarray of shape (2,)
        vergences : ndarray of shape (N,)
        places : ndarray of shape (N, 2)
            As `rays` found them.

        Returns
        -------
        ndarray of shape (N,)
            mm^2 of the pupil per area of the iris, over mm^2 of the sensor per squared tangent;
            not finite where a ray fails.
        """
        stops, lands = self._slopes(field, vergences, places)
        (stop_x, stop_h), (land_x, land_h) = stops, lands
        with np.errstate(all="ignore"):
            # Where the field moves, the place on the pupil goes along, so that q stays.
            follow = -_inverse(stop_x) @ stop_h
            opened = 1.0 / _determinant(stop_x)
            total = land_h + land_x @ follow
            slopes = places * vergences[:, None] - _seen(field)
            cosine2 = 1.0 / (1.0 + np.sum(slopes**2, axis=-1))
            return cosine2**2 * np.abs(opened / _determinant(total))

    def _slopes(self, field, vergences, places):
        """Return derivatives of places in the stop and on the sensor by place and by field.

        Returns
        -------
        stops, lands : ndarray of shape (2, N, 2, 2)
            By what is moved, ray, x and y, and the axis that it is moved along.
        """
        steps = np.zeros((2, 2, 2, 2))
        for axis in (0, 1):
            steps[0, axis, :, axis] = _NUDGE * abs(self.pupil_radius)
            steps[1, axis, :, axis] = _NUDGE
        steps[:, :, 1] *= -1.0
        # All in one trace: what is moved, along which axis, forwards or backwards, ray.
        place, seen = (steps * np.reshape(chosen, (2, 1, 1, 1)) for chosen in ((1, 0), (0, 1)))
        shape = (2, 2, 2, len(places), 2)
        at = np.broadcast_to(places + place[..., None, :], shape).reshape(-1, 2)
        seen = np.broadcast_to((_seen(field) + seen)[..., None, :], shape).reshape(-1, 2)
        traced = self._traced(seen, np.tile(vergences, 8), at, record=True)
        landing = traced.at_plane(self._configuration.sensor)
        stops = traced.hits[self.stop, :, :2] / self._radii[self.stop]
        width = 2.0 * steps[:, :, :1].max(axis=-1)[..., None, None]
        found = []
        for ends in (stops, landing):
            ends[~traced.reached] = np.nan
            ends = ends.reshape(shape)
            found.append(np.moveaxis((ends[:, :, 0] - ends[:, :, 1]) / width[:, :, 0], 1, -1))
        return found

    def _solve(self, field, vergences, targets, start):
        places, step = start.copy(), np.zeros_like(start)
        seen = _seen(field)
        stops, valid = self._at_stop(seen, vergences, places)
        error = np.where(valid, np.linalg.norm(stops - targets, axis=1), np.inf)
        going = np.flatnonzero(valid)
        step[going] = self._step(
            seen, vergences[going], places[going], stops[going] - targets[going]
        )
        for _ in range(_STEPS):
            going = np.flatnonzero(np.isfinite(error) & (error > _TOLERANCE))
            if not len(going):
                break
            trial = places[going] + step[going]
            stops, valid = self._at_stop(seen, vergences[going], trial)
            left = stops - targets[going]
            size = np.where(valid, np.linalg.norm(left, axis=1), np.inf)
            better = size < error[going]
            step[going[~better]] *= 0.5
            took = going[better]
            places[took], error[took] = trial[better], size[better]
            on = error[took] > _TOLERANCE
            again = took[on]
            if len(again):
                step[again] = self._step(seen, vergences[again], places[again], left[better][on])
        return places, error <= 1e-6

    def _step(self, seen, vergences, places, left):
        nudge = _NUDGE * abs(self.pupil_radius)
        offsets = np.array([(nudge, 0.0), (-nudge, 0.0), (0.0, nudge), (0.0, -nudge)])
        # All in one trace: far fewer calls of numpy.
        moved = (places + offsets[:, None]).reshape(-1, 2)
        found, valid = self._at_stop(seen, np.tile(vergences, 4), moved)
        found, valid = found.reshape(2, 2, -1, 2), valid.reshape(2, 2, -1).all(axis=1)
        slopes = (found[:, 0] - found[:, 1]) / (2.0 * nudge)
        matrix = np.moveaxis(np.where(valid[..., None], slopes, 0.0), 0, -1)
        determinant = _determinant(matrix)
        usable = np.abs(determinant) > 1e-30
        matrix[~usable] = np.eye(2)
        step = -np.einsum("nij,nj->ni", _inverse(matrix), left)
        step[~usable] = 0.0
        most = 0.5 * abs(self.pupil_radius)
        size = np.linalg.norm(step, axis=1, keepdims=True)
        return step * np.minimum(1.0, most / np.maximum(size, 1e-30))

    def _at_stop(self, seen, vergences, places):
        stop = self._configuration.stop
        traced = self._traced(seen, vergences, places, last=stop)
        return traced.points[:, :2] / self._radii[stop - 1], traced.reached

    def _traced(self, seen, vergences, places, **options):
        slopes = places * vergences[:, None] - seen
        directions = np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1)
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        origins = np.concatenate([places, np.full((len(places), 1), self._pupil)], axis=1)
        # Before surface 1: rays are traced from a plane that they cross on their way to it.
        return trace(
            self._configuration, Rays(origins, directions), self._wavelength, clip=False, **options
        )


def _seen(field):
    return np.array([0.0, field]) if np.ndim(field) == 0 else np.asarray(field, float)


def _determinant(matrices):
    return matrices[..., 0, 0] * matrices[..., 1, 1] - matrices[..., 0, 1] * matrices[..., 1, 0]


def _inverse(matrices):
    (a, b), (c, d) = np.moveaxis(matrices, (-2, -1), (0, 1))
    adjoint = np.moveaxis(np.array([[d, -b], [-c, a]]), (0, 1), (-2, -1))
    return adjoint / _determinant(matrices)[..., None, None]
