"""The beam of a scene point through a lens, from its pupil tables.

A beam is a regular grid of rays over the pupil as the point sees it: where each lands, with which
slope, what stops it, and which solid angle it stands for. Frame: the meridional plane of the point
is the yz plane, y grows outwards on the image. The point itself is at (0, -height, -depth), so
that the lens, which turns pictures round, has its image at +y.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from .pupil_box import beam_axes
from .pupil_tables import MARGIN, ODD_IN_X, RIMS
from .spline import spline_matrix

_SEARCH_GRID = 49
_GRID = 97
# The search for a chief ray: parts of an interval in each step, until it is 1e-14 radians.
_CHIEF_PARTS, _CHIEF_STEPS = 64, 8


@dataclass(frozen=True, eq=False)
class PupilBeam:
    """Rays of one scene point, on an n x n grid; rows along v (radial), columns along x.

    Parameters
    ----------
    image : ndarray of shape (n, n, 2)
        Landing places on the sensor plane of the tables, mm from the axis.
    slope : ndarray of shape (n, n, 2)
        dx/dz and dy/dz behind the lens.
    stop : ndarray of shape (n, n, 2)
        In units of the stop's radius wide open.
    rims : ndarray of shape (n, n, 4)
        Signed; positive inside the rims (see `CHANNELS` of the tables), the stop left out.
    weight : ndarray of shape (n, n)
        Area of the cell of a ray, square to the chief ray at the pupil, mm^2; for a near point the
        solid angle times the squared distance of the pupil.
    transmission : ndarray of shape (n, n)
    pupil : ndarray of shape (n, n, 2)
        Places in the plane through the pupil's centre square to the chief ray, mm.
    chief : ndarray of shape (4,)
        Landing place and slope of the ray through the pupil's centre.
    angle : float
        Of the chief ray in front of the lens, radians.
    distance : float
        Point to pupil along the chief ray, mm; inf for a parallel beam.
    stop_scale : float
        Radius of the stop for which the grid was laid out, in units of that wide open.
    """

    image: np.ndarray
    slope: np.ndarray
    stop: np.ndarray
    rims: np.ndarray
    weight: np.ndarray
    transmission: np.ndarray
    pupil: np.ndarray
    chief: np.ndarray
    angle: float
    distance: float
    stop_scale: float

    @property
    def clearance(self):
        """Smallest of `rims`, shape (n, n)."""
        return self.rims.min(axis=-1)

    def landing(self, shift):
        """Landing places on a sensor that stands elsewhere.

        Parameters
        ----------
        shift : float
            mm behind the sensor plane of the tables.

        Returns
        -------
        ndarray of shape (n, n, 2)
            mm from the axis.
        """
        return self.image + self.slope * shift

    def refined(self, count):
        """Return the beam on a finer grid of cell centres, by cubic splines.

        Parameters
        ----------
        count : int
            Rays along a side.

        Returns
        -------
        PupilBeam
        """
        n = self.weight.shape[0]
        at = (np.arange(count) + 0.5) / count * (n - 1)
        matrix = spline_matrix(np.arange(n), at)
        packed = np.concatenate(
            [
                self.image,
                self.slope,
                self.stop,
                self.pupil,
                self.rims,
                np.stack([self.weight, self.transmission], axis=-1),
            ],
            axis=-1,
        )
        fine = np.tensordot(matrix, packed, axes=(1, 0))
        fine = np.moveaxis(np.tensordot(matrix, fine, axes=(1, 1)), 0, 1)
        # Cells of the coarse grid are (n - 1)^2 in all.
        share = ((n - 1) / count) ** 2
        return PupilBeam(
            image=fine[..., 0:2],
            slope=fine[..., 2:4],
            stop=fine[..., 4:6],
            rims=fine[..., 8:12],
            weight=np.maximum(fine[..., 12], 0.0) * share,
            transmission=np.clip(fine[..., 13], 0.0, 1.0),
            pupil=fine[..., 6:8],
            chief=self.chief,
            angle=self.angle,
            distance=self.distance,
            stop_scale=self.stop_scale,
        )


def beam_from_infinity(tables, angle, f_number=None, wavelength=0, box=None):
    """Beam of a point at infinity.

    Parameters
    ----------
    tables : PupilTables
    angle : float
        Field angle, radians, at least 0.
    f_number : float or None
        None: wide open.
    wavelength : int
        Index into `tables.wavelengths_nm`.
    box : tuple of 4 float or None
        Span of the grid in the plane of the pupil, x and then v, mm; None: what is open.

    Returns
    -------
    PupilBeam
    """
    return _beam(tables, float(angle), np.inf, f_number, wavelength, box)


def beam_from_point(tables, height, depth, f_number=None, wavelength=0, box=None):
    """Beam of a near point.

    Parameters
    ----------
    tables : PupilTables
    height : float
        Distance from the axis, mm, at least 0.
    depth : float
        Distance in front of the vertex of surface 1 along the axis, mm, > 0.
    f_number : float or None
        None: wide open.
    wavelength : int
        Index into `tables.wavelengths_nm`.
    box : tuple of 4 float or None
        Span of the grid in the plane of the pupil, x and then v, mm; None: what is open.

    Returns
    -------
    PupilBeam

    Raises
    ------
    InputError
        If the point is not in front of the lens.
    """
    return _beam(tables, *_chief_ray(tables, height, depth), f_number, wavelength, box)


def _chief_ray(tables, height, depth):
    """Angle of the ray from a point to the pupil's centre, and the pupil's distance along it."""
    if not (np.isfinite(height) and np.isfinite(depth) and depth > 0.0 and height >= 0.0):
        raise InputError(
            f"a point {depth:g} mm in front of the lens and {height:g} mm from its axis casts no"
            " beam; the depth must be above 0 and finite"
        )
    angle = _chief_angle(tables, height, depth)
    direction, _ = beam_axes(angle)
    point = np.array([0.0, -height, -depth])
    distance = _pupil_along(tables, angle) - point @ direction
    if distance <= 0.0:
        raise InputError(
            f"a point {depth:g} mm in front of surface 1 lies behind the entrance pupil"
            f" ({distance:.4g} mm); move it away from the lens"
        )
    return angle, distance


def box_from_infinity(tables, angle, f_number=None):
    """Return the `box` that `beam_from_infinity` finds."""
    return _open_box(tables, float(angle), np.inf, _stop_scale(tables, f_number), 0)


def box_from_point(tables, height, depth, f_number=None):
    """Return the `box` that `beam_from_point` finds."""
    angle, distance = _chief_ray(tables, height, depth)
    return _open_box(tables, angle, distance, _stop_scale(tables, f_number), 0)


def _stop_scale(tables, f_number):
    return 1.0 if f_number is None else min(1.0, tables.f_number / f_number)


def _open_box(tables, angle, distance, scale, wavelength):
    half_x, _, half_v = tables.curves_at(angle)[1:]
    wide = 1.0 + MARGIN if np.isinf(distance) else 1.5
    box = (-half_x * wide, half_x * wide, -half_v * wide, half_v * wide)
    # The open part of a small stop, a near point's or a vignetted pupil is smaller than the box.
    for _ in range(2):
        x, v, values, _ = _rays(tables, angle, distance, box, _SEARCH_GRID, wavelength)
        box = _open_part(x, v, values, scale) or box
    return tuple(map(float, box))


def _beam(tables, angle, distance, f_number, wavelength, given=None):
    scale = _stop_scale(tables, f_number)
    box = given or _open_box(tables, angle, distance, scale, wavelength)
    x, v, values, solid = _rays(tables, angle, distance, box, _GRID, wavelength)
    cell = (x[0, 1] - x[0, 0]) * (v[1, 0] - v[0, 0])
    centre = _rays(tables, angle, distance, (-1e-6, 1e-6, -1e-6, 1e-6), 3, wavelength)[2][1, 1]
    return PupilBeam(
        image=values[..., 0:2],
        slope=values[..., 2:4],
        stop=values[..., 4:6],
        rims=values[..., RIMS],
        weight=solid * cell,
        transmission=values[..., 10],
        pupil=np.stack([x, v], axis=-1),
        chief=centre[:4],
        angle=angle,
        distance=float(distance),
        stop_scale=scale,
    )


def _rays(tables, angle, distance, box, grid, wavelength):
    """Rays through a regular grid in the plane of the pupil, and what the tables say of them."""
    if grid % 2 and abs(box[0] + box[1]) < 1e-9 * abs(box[1]):
        # Mirror symmetry of a lens of revolution: half of the columns are looked up.
        half = _columns(tables, angle, distance, box, grid, wavelength, grid // 2)
        x, v, values, solid = (
            np.concatenate([part[:, :0:-1] * sign, part], axis=1)
            for part, sign in zip(half, (-1.0, 1.0, ODD_IN_X, 1.0), strict=True)
        )
        return x, v, values, solid
    return _columns(tables, angle, distance, box, grid, wavelength, 0)


def _columns(tables, angle, distance, box, grid, wavelength, first):
    """Return what `_rays` does, from a column on."""
    x, v = np.meshgrid(np.linspace(*box[:2], grid)[first:], np.linspace(*box[2:], grid))
    centre = tables.curves_at(angle)[2]
    if np.isinf(distance):
        flat = np.full(x.size, angle)
        values = tables.look_up(flat, x.ravel(), (v + centre).ravel(), wavelength)
        return x, v, values.reshape(*x.shape, -1), np.ones_like(x)
    direction, axis = beam_axes(angle)
    along = _pupil_along(tables, angle)
    point = centre * axis + (along - distance) * direction
    towards = distance * direction + v[..., None] * axis
    towards[..., 0] += x
    length = np.linalg.norm(towards, axis=-1)
    towards /= length[..., None]
    sin = np.hypot(towards[..., 0], towards[..., 1])
    ray_angle = np.arctan2(sin, towards[..., 2])
    # The meridional plane of each ray; on the axis any will do.
    straight = sin < 1e-12
    mx = np.where(straight, 0.0, towards[..., 0] / np.where(straight, 1.0, sin))
    my = np.where(straight, 1.0, towards[..., 1] / np.where(straight, 1.0, sin))
    cos = towards[..., 2]
    ray_x = point[0] * my - point[1] * mx
    ray_v = cos * (point[0] * mx + point[1] * my) - sin * point[2]
    found = tables.look_up(ray_angle.ravel(), ray_x.ravel(), ray_v.ravel(), wavelength)
    found = found.reshape(*x.shape, -1)
    values = found.copy()
    for first in (0, 2, 4):
        across, outwards = found[..., first], found[..., first + 1]
        values[..., first] = across * my + outwards * mx
        values[..., first + 1] = outwards * my - across * mx
    return x, v, values, (distance / length) ** 3


def _open_part(x, v, values, scale):
    """Box of the rays that pass, wider by a cell and a half."""
    stop = np.hypot(values[..., 4], values[..., 5])
    inside = (values[..., RIMS].min(axis=-1) > 0.0) & (stop < scale)
    if not inside.any():
        # A stop between the rays: the box of the nearest one to its middle.
        inside = stop == stop.min()
    step_x, step_v = x[0, 1] - x[0, 0], v[1, 0] - v[0, 0]
    return (
        x[inside].min() - 1.5 * step_x,
        x[inside].max() + 1.5 * step_x,
        v[inside].min() - 1.5 * step_v,
        v[inside].max() + 1.5 * step_v,
    )


def _pupil_along(tables, angle):
    """Place of the pupil along the chief ray, mm: where neighbouring chief rays meet."""
    step = tables.curve_step
    low = max(angle - step, 0.0)
    rise = tables.curves_at(angle + step)[2] - tables.curves_at(low)[2]
    return -rise / (angle + step - low)


def _chief_angle(tables, height, depth):
    """Angle of the ray from a point to the centre of the pupil's box."""
    low, high = 0.0, 0.5 * np.pi
    # The point rises over the chief ray with the angle: there is one crossing.
    for _ in range(_CHIEF_STEPS):
        angles = np.linspace(low, high, _CHIEF_PARTS + 1)
        over = depth * np.sin(angles) - height * np.cos(angles) - tables.curves_at(angles)[:, 2]
        part = int(np.searchsorted(over[1:-1] > 0.0, True))
        low, high = angles[part], angles[part + 1]
    return 0.5 * (low + high)
