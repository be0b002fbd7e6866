"""A real lens for lens samples: where the ray of a point through a place of the iris lands.

A point of field H (tangents) and vergence V (one over its distance along the axis from the entrance
pupil), seen through the place q of the iris (in units of its radius), lands on the sensor at s; the
picture has it at ``t = T(s / m)``, with m the paraxial scale of the picture, so that t is H but for
what the lens does. T makes the picture free of distortion: it takes the rays through the middle of
the iris, of points in the plane of focus, to their H. Without it, the picture has the distortion.

What is kept is what the lens adds to a thin one,

    t(H, V, q) - H = p q (Vf - V) + p B(H, V, q) + C(H, V)

with p the radius of the paraxial pupil, Vf the vergence of the focus, B the aberrations (0 at
q = 0) and C the movement of the rays through the middle. B is a sum of `disc_terms` over q; its
coefficients are functions of the field alone, for four vergences, between which all is a cubic.
Lens of revolution: they are found for points along one direction and turned.

The light of a ray (`StopAim.throughput`) and its clearances of the rims do not depend on the
vergence, for a place of the iris and one of the sensor make one ray: they are those of points in
focus. Losses at the surfaces of the glass are left out.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import FocusError, PrescriptionError
from ...optics.focus import focused
from ...optics.glass import REFERENCE_WAVELENGTH_NM as _LINE
from ...optics.paraxial import first_order
from ..tables.spline import spline_matrix
from ..tables.undistorted import undistorted
from .cylinder_rays import cylinder_rays
from .lens_colors import LensColors, trace_colors, traced_wavelengths
from .ray_fan import RayFan
from .stop_rays import StopAim
from .stop_shapes import paraxial_pupil, stop_shapes

_MM = 1000.0
_FIELDS = 17
VERGENCES = 4
# The nearest point of the fit is this many times as near as the focus, and at least this near, in
# focal lengths, however far the focus is; nearer ones go on as they went.
_NEAREST, _NEAREST_LENGTHS = 4.0, 20.0
# Room before surface 1 that no point of the fit comes into, in focal lengths.
_ROOM = 0.25
# Fields beyond the lens' own, in which rays are looked for; fewest of them that light comes from.
_BEYOND, _FEWEST = 1.15, 5
_WIDEST_DEG = 80.0
_FOCUS_STEPS = 8


@dataclass(frozen=True, eq=False)
class LensRays:
    """Where rays land, and with how much light, for one lens at one focus and f-number.

    Parameters
    ----------
    orders : ndarray of int, shape (T, 2)
        Of the `disc_terms`.
    fields : ndarray of shape (F,)
        Tangents, from 0.
    vergences : ndarray of shape (4,)
        Rising, 1/m.
    focus_vergence : float
        1/m.
    largest_vergence : float
        Of the points that the lens was traced for, 1/m.
    aberrations : ndarray of shape (F, 4, 2, T)
        Coefficients of B, 1/m, for a point in direction e1 of the picture: of the part along e1
        (cosine terms of the angle from e1) and of that along e2, e1 turned by 90 degrees (sine
        terms). The mean is included; B is what is left after its value at q = 0.
    chief : ndarray of shape (F, 4)
        C along e1.
    light : ndarray of shape (F, T)
        Throughput over that of the middle of the picture, cosine terms.
    rims : ndarray of shape (F, S, T)
        1 - (radius / semi-diameter)^2 at the rims that may cut, cosine terms.
    distorted : ndarray of shape (M, 2)
        Fields, and where the ray through the middle of the iris lands of a point in focus there,
        over m; both rising from 0.
    flat : bool
        Whether T takes the distortion away.
    complete : bool
        Whether the fields reach as far as they were wanted; else no light comes from farther out.
    colors : LensColors or None
        What other wavelengths change, where it was asked for and the glasses have dispersion.
    most_light : float
        The most throughput of a ray that no rim stops: sums of terms may go astray beyond.
    """

    orders: np.ndarray
    fields: np.ndarray
    vergences: np.ndarray
    focus_vergence: float
    largest_vergence: float
    aberrations: np.ndarray
    chief: np.ndarray
    light: np.ndarray
    rims: np.ndarray
    distorted: np.ndarray
    flat: bool
    complete: bool = True
    colors: LensColors | None = None
    most_light: float = np.inf

    # Whether other wavelengths can be traced.
    parts_colors = True

    def of_fields(self, values, odd, wanted):
        """Interpolate over the field.

        Parameters
        ----------
        values : ndarray of shape (F, ...)
        odd : ndarray of bool, broadcast to values[0]
            Which change their sign on the other side of the axis.
        wanted : ndarray of shape (P,)
            Fields, at least 0; beyond the last one it is that.

        Returns
        -------
        ndarray of shape (P, ...)
        """
        mirrored = np.where(odd, -values[:0:-1], values[:0:-1])
        nodes = np.concatenate([-self.fields[:0:-1], self.fields])
        matrix = spline_matrix(nodes, np.minimum(wanted, self.fields[-1]))
        return np.tensordot(matrix, np.concatenate([mirrored, values]), 1)

    @property
    def last_seen(self):
        """Distance from the axis in the picture from which on no light comes; may be infinite."""
        if self.complete:
            return np.inf
        if self.flat:
            return float(self.fields[-1])
        return float(np.interp(self.fields[-1], *self.distorted.T))

    def field_shown(self, tangents):
        """Return the fields of points in focus that are shown at distances from the axis.

        Parameters
        ----------
        tangents : ndarray of shape (P,)
            In the picture, at least 0.

        Returns
        -------
        ndarray of shape (P,)
        """
        return tangents if self.flat else undistorted(self.distorted, tangents)

    @property
    def farthest(self):
        """The farthest field that was traced, as a tangent."""
        return float(self.fields[-1])

    def places_shown(self, fields):
        """Return where fields are shown in focus, both of shape (P, 2), as tangents."""
        if self.flat:
            return fields
        away = np.hypot(*fields.T)
        shown = np.interp(away, *self.distorted.T)
        return fields * (shown / np.maximum(away, 1e-30))[:, None]

    # Height of the pupil over its width.
    stretch = 1.0
    of_revolution = True

    def moves(self, nodes):
        """Lay out the aberrations over places of the field.

        Parameters
        ----------
        nodes : ndarray of shape (P, 2)

        Returns
        -------
        moves : ndarray of shape (2 T, P, 4, 2)
            Coefficients of the terms in the picture's frame, for each power of the vergence over
            the largest, x and y, over the radius of the pupil.
        chief : ndarray of shape (P, 4, 2)
            Of the rays through the middle of the iris.
        """
        away, turn = _polar(nodes)
        # Seen from the other side of the axis, both directions of the picture are turned round.
        aberrations = self.of_fields(self.aberrations, self.orders[:, 1] % 2 == 0, away)
        chief = self.of_fields(self.chief, True, away)
        powers = np.linalg.inv((self.vergences / self.largest_vergence)[:, None] ** np.arange(4))
        aberrations = np.einsum("jk,nkct->njct", powers, aberrations)
        angle = turn[:, None] * self.orders[:, 1]
        cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
        along, across = aberrations[:, :, 0], aberrations[:, :, 1]
        first, second = np.cos(turn)[:, None, None], np.sin(turn)[:, None, None]
        # The cosine and the sine term of each angle from e1 in terms of those from the x axis.
        one = np.concatenate([along * cos, along * sin], axis=-1)
        other = np.concatenate([-across * sin, across * cos], axis=-1)
        moves = np.stack([one * first - other * second, one * second + other * first], axis=-2)
        axes = np.concatenate([first, second], axis=-1)
        return np.moveaxis(moves, -1, 0), (chief @ powers.T)[..., None] * axes

    def light_and_rims(self, nodes):
        """Lay out the light, then the clearances of the rims, over places of the picture.

        Parameters
        ----------
        nodes : ndarray of shape (P, 2)

        Returns
        -------
        ndarray of shape (1 + S, 2 T, P)
            Coefficients of the terms, by the place where points in focus are shown.
        """
        away, turn = _polar(nodes)
        every = np.concatenate([self.light[:, None], self.rims], axis=1)
        every = self.of_fields(every, self.orders[:, 1] % 2 == 1, self.field_shown(away))
        angle = turn[:, None, None] * self.orders[:, 1]
        turned = np.concatenate([every * np.cos(angle), every * np.sin(angle)], axis=-1)
        return np.moveaxis(turned, 0, -1)


def lens_rays(
    prescription,
    label,
    focus_distance,
    f_number,
    largest_tangent,
    flat=True,
    sides=None,
    colored=False,
):
    """Trace a lens for lens samples.

    Parameters
    ----------
    prescription : Prescription
    label : str or None
        Of the zoom position.
    focus_distance : float
        From the centre of the entrance pupil, m.
    f_number : float
    largest_tangent : float
        Of the fields that are wanted; fewer are traced where no light comes through.
    flat : bool
        Without distortion.
    sides : tuple of 2 float or None
        Largest tangents along x and y, of which a lens with cylinders makes use.
    colored : bool
        With `colors`; a lens with cylinders has none.

    Returns
    -------
    LensRays or CylinderRays
        At the d line, to which the lens is focused.

    Raises
    ------
    FocusError, PrescriptionError
        If the lens cannot be focused there, or no ray comes through.
    """
    configuration, order = _focused(prescription, label, focus_distance)
    focus = 1.0 / (focus_distance * _MM)
    room = max(order.enp_z, 0.0) + _ROOM * order.efl
    if focus * room >= 1.0:
        raise FocusError(
            f"focus distance {focus_distance:g} m is inside the lens; focus farther away"
        )
    nearest = max(_NEAREST * focus, 1.0 / (_NEAREST_LENGTHS * order.efl))
    nearest = min(nearest, 1.0 / room)
    turn = (np.arange(VERGENCES) + 0.5) / VERGENCES * np.pi
    vergences = nearest * 0.5 * (1.0 - np.cos(turn))
    lens = configuration.stopped_down(max(f_number, configuration.f_number))
    if not lens.of_revolution:
        sides = sides or (largest_tangent, largest_tangent)
        return cylinder_rays(lens, order.enp_z, focus, vergences, sides, flat, _LINE)
    scale, radius = paraxial_pupil(lens, order.enp_z, focus, _LINE)
    found = []
    for stopped, places in stop_shapes(lens, order.enp_z, radius, focus, _LINE):
        aim = StopAim(stopped, order.enp_z, radius * places, _LINE)
        fan = RayFan(aim, scale, abs(radius), focus, vergences)
        axial = fan.follow(np.zeros(1))
        if fan.folded or not axial:
            continue
        if fan.strays(axial):
            fan = RayFan(aim, scale, abs(radius), focus, vergences, fine=True)
        fields, found = _followed(fan, lens.half_field_deg, largest_tangent)
        if not fan.folded:
            break
    if fan.folded:
        raise PrescriptionError(
            f"at f/{f_number:.3g} it turns rays back before the rim of its stop, so that places"
            " in it do not tell them apart; stop it down"
        )
    if len(found) < _FEWEST:
        raise PrescriptionError("no ray gets through the lens but near its axis")
    distorted = fan.chiefs(fields)
    taken = distorted if flat else None
    fitted = fan.fitted(fields, found, taken)
    colors = None
    wavelengths = traced_wavelengths(configuration) if colored else ()
    if wavelengths:
        colors = trace_colors(fan, fields, fitted[:2], wavelengths, taken)
    return LensRays(
        fan.orders,
        fields,
        vergences * _MM,
        focus * _MM,
        nearest * _MM,
        *fitted,
        distorted,
        flat,
        bool(fields[-1] >= largest_tangent * (1.0 - 1e-9)),
        colors,
        fan.most_light(found),
    )


def _followed(fan, half_field_deg, largest_tangent):
    """Return fields and their rays: as far as they are wanted, or to where no light comes through.

    In steps beyond the lens' own field, so that those that have light are looked at closely.
    """
    farthest = half_field_deg
    while True:
        farthest = min(farthest * _BEYOND, _WIDEST_DEG)
        limit = np.tan(np.radians(farthest))
        fields = np.linspace(0.0, min(largest_tangent, limit), _FIELDS)
        found = fan.follow(fields)
        whole = limit >= largest_tangent or farthest == _WIDEST_DEG
        if whole or len(found) < len(fields) or fan.is_dark(found[-1]):
            return fields[: len(found)], found


def _focused(prescription, label, focus_distance):
    """Return the lens focused at a distance from its entrance pupil, and its first order."""
    wide = lens = prescription.configuration(label)
    for _ in range(_FOCUS_STEPS):
        distance = focus_distance * _MM - first_order(lens).enp_z
        try:
            lens = focused(wide, distance, prescription.focus)
        except PrescriptionError as error:
            raise FocusError(f"{error}; focus farther away") from error
    return lens, first_order(lens)


def _polar(places):
    return np.hypot(*places.T), np.arctan2(places[:, 1], places[:, 0])
