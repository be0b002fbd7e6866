"""A lens with cylinders for lens samples: as `lens_rays`, without its symmetry of revolution.

Such a lens is its own mirror image to both sides of the x and of the y axis: points of a quarter of
the field are looked at, each with rays over the whole iris. Across and along the cylinders the lens
has two focal lengths and two pupils: the picture is stretched to what a pinhole camera sees, as a
projector does with an anamorphic film, and of the iris it sees an ellipse.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..tables.spline import spline_matrix
from .disc_terms import disc_orders, disc_terms
from .landing import landed
from .stop_rays import StopAim
from .stop_shapes import paraxial_pupil

_MM, _PARAXIAL = 1000.0, 1e-4
_DEGREE = 9
_RADII, _ANGLES = 7, 20
# Fields along each half axis, and steps more that the distortion is followed beyond.
_FIELDS, _FURTHER = 5, 2
# Steps to the field that is shown at a place.
_STEPS = 8
# Weight in the fit of rays that a rim stops, as of `ray_fan`; and of what is made up.
_STEEP, _LEAST, _KEPT = 30.0, 1e-3, 1e-7
_MOST_LIGHT, _LOST_RIM = 3.0, 0.05
_NEAR_RIM, _MOST_RIMS = 0.05, 8


@dataclass(frozen=True, eq=False)
class CylinderRays:
    """Where rays land, and with how much light; what `LensRays` is for a lens of revolution.

    Parameters
    ----------
    orders : ndarray of int, shape (T, 2)
        Of the `disc_terms`.
    fields : tuple of 2 ndarray
        Tangents along x and y, from 0, shapes (X,) and (Y,).
    vergences, focus_vergence, largest_vergence, flat
        As of `LensRays`.
    stretch : float
        Height of the pupil over its width.
    scale : ndarray of shape (2,)
        Of the picture along x and y, mm a tangent.
    aberrations : ndarray of shape (X, Y, 4, 2, 2 T)
        Coefficients of B over the height of the pupil, 1/m; of x and of y.
    chief : ndarray of shape (X, Y, 4, 2)
        Movement of the rays through the middle of the iris.
    light : ndarray of shape (X, Y, 2 T)
    rims : ndarray of shape (X, Y, S, 2 T)
    distortion : Distortion
    """

    orders: np.ndarray
    fields: tuple
    vergences: np.ndarray
    focus_vergence: float
    largest_vergence: float
    flat: bool
    stretch: float
    scale: np.ndarray
    aberrations: np.ndarray
    chief: np.ndarray
    light: np.ndarray
    rims: np.ndarray
    distortion: object

    # Where no light comes from is in the light itself.
    last_seen = np.inf
    parts_colors, colors = False, None
    of_revolution = False
    most_light = _MOST_LIGHT

    @property
    def farthest(self):
        """The farthest field that was traced, as a tangent."""
        return float(np.hypot(*(each[-1] for each in self.fields)))

    def places_shown(self, fields):
        """Return where fields are shown in focus; as of `LensRays`."""
        return fields if self.flat else self.distortion.done(fields)

    def moves(self, nodes):
        """Lay out the aberrations over places of the field; as of `LensRays`."""
        cosine_x, cosine_y = self._odd()
        flips = np.array([True, False])[:, None]
        found = _interpolated(
            self.fields, self.aberrations, cosine_x ^ flips, cosine_y ^ ~flips, nodes
        )
        chief = _interpolated(self.fields, self.chief, flips[:, 0], ~flips[:, 0], nodes)
        powers = np.linalg.inv((self.vergences / self.largest_vergence)[:, None] ** np.arange(4))
        moves = np.einsum("jk,pkct->tpjc", powers, found)
        return moves, np.einsum("jk,pkc->pjc", powers, chief)

    def terms(self, places):
        """Return the terms at places of the iris, shapes (N, 2 T) and (N, 2)."""
        return disc_terms(self.orders, places).reshape(len(places), -1)

    def landed(self, aperture_radius, grid, wanted):
        """Return light and clearances by the places where rays land; see `landing.landed`."""
        return landed(self, aperture_radius, grid, wanted)

    def light_and_rims(self, nodes):
        """Lay out light and clearances of the rims; as of `LensRays`."""
        seen = nodes if self.flat else self.distortion.undone(nodes)
        every = np.concatenate([self.light[:, :, None], self.rims], axis=2)
        return np.moveaxis(_interpolated(self.fields, every, *self._odd(), seen), 0, -1)

    def _odd(self):
        """Which terms of a number change their sign with x, and with y, shape (2 T,) each."""
        odd = self.orders[:, 1] % 2 == 1
        return np.concatenate([odd, ~odd]), np.repeat([False, True], len(odd))


@dataclass(frozen=True, eq=False)
class Distortion:
    """Where the rays through the middle of the iris land, of points in focus.

    Parameters
    ----------
    fields : tuple of 2 ndarray
    shift : ndarray of shape (X, Y, 2)
        How far from the place where a pinhole camera has them, tangents.
    """

    fields: tuple
    shift: np.ndarray

    def done(self, fields):
        """Return the places where fields are shown, shape (P, 2) both."""
        return fields + self._shifts(fields)

    def undone(self, places):
        """Return the fields that are shown at places, shape (P, 2) both."""
        seen = places
        for _ in range(_STEPS):
            seen = places - self._shifts(seen)
        return seen

    def _shifts(self, fields):
        odd = np.array([True, False])
        return _interpolated(self.fields, self.shift, odd, ~odd, fields)


def cylinder_rays(lens, pupil, focus, vergences, tangents, flat, wavelength_nm):
    """Trace a lens with cylinders for lens samples.

    Parameters
    ----------
    lens : Configuration
        Focused, its stop as far open as it is used.
    pupil : float
        z of the entrance pupil of the yz plane, mm.
    focus : float
        Vergence of the focus, 1/mm.
    vergences : ndarray of shape (4,)
        1/mm.
    tangents : tuple of 2 float
        Of the farthest fields along x and y.
    flat : bool
    wavelength_nm : float

    Returns
    -------
    CylinderRays

    Raises
    ------
    PrescriptionError
        If rays near the axis do not get through.
    """
    return _Quarter(lens, pupil, focus, vergences, wavelength_nm).traced(tangents, flat)


class _Quarter:
    """Rays of points of a quarter of the field."""

    def __init__(self, lens, pupil, focus, vergences, wavelength_nm):
        radii = np.array(
            [paraxial_pupil(lens, pupil, focus, wavelength_nm, along)[1] for along in np.eye(2)]
        )
        self.radii = np.abs(radii)
        self.aim = StopAim(lens, pupil, self.radii[1], wavelength_nm)
        # The pupil across the width is elsewhere: its rays do not go through the middle of this.
        middle = np.array([focus]), np.zeros((1, 2)), np.zeros((1, 2))
        self.scale = np.array(
            [
                (self.aim.rays(_PARAXIAL * along, *middle).landing[0] @ along) / _PARAXIAL
                for along in np.eye(2)
            ]
        )
        self.focus, self.vergences = focus, vergences
        self.slabs = np.append(vergences, focus)
        self.orders = disc_orders(_DEGREE)
        radius = np.sin(0.5 * np.pi * (np.arange(_RADII) + 1.0) / _RADII)
        angle = 2.0 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
        # A row for each angle, from the middle outwards.
        radius = np.broadcast_to(np.append(0.0, radius), (_ANGLES, _RADII + 1))
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        self.places = radius[..., None] * ring[:, None]
        self.local = self.places.reshape(-1, 2)
        self.basis = disc_terms(self.orders, self.local).reshape(len(self.local), -1)
        # The stop may be seen upside down.
        self.targets = np.tile(self.local * np.sign(radii), (len(self.slabs), 1))

    def traced(self, tangents, flat):
        fields = tuple(np.linspace(0.0, each, _FIELDS) for each in tangents)
        distortion = self._distortion(fields)
        rows, before = [], None
        for x in fields[0]:
            row, last = [], before
            for y in fields[1]:
                seen = np.array([x, y])
                rays = self._rays(seen, last)
                last = rays.places if rays.found.any() else last
                if y == 0.0:
                    before = last
                row.append(self._fitted(seen, rays, distortion if flat else None))
            rows.append(row)
        aberrations, chief, light, rims, least = (
            np.array([[node[k] for node in row] for row in rows]) for k in range(5)
        )
        least = least.min(axis=(0, 1))
        order = np.argsort(least)[:_MOST_RIMS]
        cutting = np.sort(order[least[order] < _NEAR_RIM])
        return CylinderRays(
            self.orders, fields, self.vergences * _MM, self.focus * _MM,
            float(self.vergences.max()) * _MM, flat, float(self.radii[1] / self.radii[0]),
            self.scale, aberrations, chief, light, rims[:, :, cutting], distortion,
        )  # fmt: skip

    def _distortion(self, fields):
        longer = tuple(
            np.append(each, each[-1] + each[1] * np.arange(1, _FURTHER + 1)) for each in fields
        )
        shift = np.zeros((len(longer[0]), len(longer[1]), 2))
        target = np.zeros((1, 2))
        column = np.zeros((1, 2))
        for i, x in enumerate(longer[0]):
            start = column
            for j, y in enumerate(longer[1]):
                seen = np.array([x, y])
                rays = self.aim.rays(seen, np.array([self.focus]), target, start)
                if rays.found[0]:
                    shift[i, j] = rays.landing[0] / self.scale - seen
                    start = rays.places
                    column = start if j == 0 else column
                else:
                    # Where none comes through it goes on as it was.
                    shift[i, j] = shift[i, j - 1] if j else shift[i - 1, j]
        return Distortion(longer, shift)

    def _rays(self, seen, last):
        start = np.tile(self.local * self.radii, (len(self.slabs), 1)) if last is None else last
        vergences = np.repeat(self.slabs, len(self.local))
        rays = self.aim.rays(seen, vergences, self.targets, start)
        # A ray that was not found is no place to begin from.
        fresh = np.tile(self.local * self.radii, (len(self.slabs), 1))
        return replace(rays, places=np.where(rays.found[:, None], rays.places, fresh))

    def _fitted(self, seen, rays, distortion):
        """Return aberrations, chief, light, rims of a field, and the least clearance of each."""
        slabs, count = len(self.slabs), len(self.local)
        known = rays.found.reshape(slabs, count)
        vergences = np.full(count, self.focus)
        with np.errstate(all="ignore"):
            light = self.aim.throughput(seen, vergences, rays.places[-count:])
        light *= abs(np.prod(self.scale) / np.prod(self.radii))
        shown = rays.landing / self.scale
        if distortion is not None:
            shown[rays.found] = distortion.undone(shown[rays.found])
        shown = shown.reshape(slabs, count, 2)
        rims = np.moveaxis(rays.rims.reshape(-1, slabs, count), 1, 0)
        here, chief = [], []
        for k, vergence in enumerate(self.vergences):
            held, clear = self._held(known[k], rims[k])
            own = shown[k] - self.local * self.radii * (self.focus - vergence)
            fitted = self._fit(_spread(known[k], own), held).T
            chief.append(fitted @ self._middle - seen if known[k].any() else np.zeros(2))
            here.append(fitted / self.radii[1])
        held, clear = self._held(known[-1], rims[-1])
        sure = known[-1] & (light < _MOST_LIGHT)
        light = np.where(sure, light, 0.0)
        light = self._fit(_spread(sure, light[:, None]), held)[:, 0]
        least = np.where(known[-1], rims[-1], 1.0).min(axis=1)
        least[self.aim.stop] = 1.0
        return np.array(here) * _MM, np.array(chief), light, self._fit(clear.T, held).T, least

    @property
    def _middle(self):
        return self.basis[0]

    def _held(self, known, rims):
        """Return the weights of rays in a fit, and clearances that go on where rays are lost."""
        if not known.all():
            rims = _ended(known, rims)
        others = np.delete(rims, self.aim.stop, axis=0).min(axis=0)
        weight = np.exp(_STEEP * np.minimum(others, 0.0))
        return np.maximum(np.where(known, weight, np.minimum(weight, _LEAST)), _LEAST), rims

    def _fit(self, values, weight):
        used = np.abs(self.basis).max(axis=0) > 1e-9
        root = np.sqrt(weight)[:, None]
        matrix = self.basis[:, used] * root
        normal = matrix.T @ matrix + _KEPT * len(values) * np.eye(used.sum())
        result = np.zeros((self.basis.shape[1], values.shape[1]))
        result[used] = np.linalg.solve(normal, matrix.T @ (values * root))
        return result


def _outermost(known):
    """Return for each ray itself, else the outermost before it on its angle that is known."""
    known = known.reshape(_ANGLES, _RADII + 1)
    row = np.arange(_RADII + 1)
    reach = np.logical_and.accumulate(known, axis=1).sum(axis=1, keepdims=True) - 1
    reach = np.maximum(reach, 0)
    columns = np.where(known, row, reach)
    first = (np.arange(_ANGLES) * (_RADII + 1))[:, None]
    index, before = first + columns, first + np.maximum(columns - 1, 0)
    beyond = np.where(known, 0, np.maximum(row - reach, 0))
    return index.ravel(), before.ravel(), beyond.ravel()


def _spread(known, values):
    return values if known.all() else values[_outermost(known)[0]]


def _ended(known, rims):
    """Let clearances go on where rays are lost, and the least one of them end."""
    index, before, beyond = _outermost(known)
    rims = rims[:, index] + np.minimum(rims[:, index] - rims[:, before], 0.0) * beyond
    least = rims.argmin(axis=0), np.arange(rims.shape[1])
    lost = ~known
    ends = -_LOST_RIM * np.maximum(beyond, 1)
    rims[least] = np.where(lost, np.minimum(rims[least], ends), rims[least])
    return rims


def _interpolated(fields, values, odd_x, odd_y, nodes):
    """Interpolate tables of a quarter of the field at places of all of it.

    Parameters
    ----------
    fields : tuple of 2 ndarray
    values : ndarray of shape (X, Y, ...)
    odd_x, odd_y : ndarray of bool, broadcast to values[0, 0]
        Which change their sign on the other side.
    nodes : ndarray of shape (P, 2)

    Returns
    -------
    ndarray of shape (P, ...)
    """
    values = np.concatenate([np.where(odd_x, -values[:0:-1], values[:0:-1]), values])
    mirrored = values[:, :0:-1]
    values = np.concatenate([np.where(odd_y, -mirrored, mirrored), values], axis=1)
    matrices = [
        spline_matrix(np.concatenate([-each[:0:-1], each]), np.clip(at, -each[-1], each[-1]))
        for each, at in zip(fields, nodes.T, strict=True)
    ]
    count = values.shape[:2]
    flat = values.reshape(*count, -1)
    pairs = matrices[0][:, :, None] * matrices[1][:, None]
    # Not -1: there may be no place, where no ray of a field comes through.
    pairs = pairs.reshape(len(nodes), count[0] * count[1])
    return (pairs @ flat.reshape(-1, flat.shape[2])).reshape(len(nodes), *values.shape[2:])
