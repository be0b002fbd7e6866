"""Optical vignetting of a lens without a prescription: the artist's cat's eye (methods 13).

Seen along the chief ray of a field angle a, the rims in front of and behind the stop move across
the pupil in proportion to tan a, the front ones one way, the rear ones the other. What passes is
the intersection of the pupil with the rims' discs. One rim cuts a hard edge. Where several rims
of a lens take their share one after the other, the edge is soft: a `Rim` of several members is a
row of equal discs, evenly spread up to the full shift, and a place lets through the share of
members that clear it.

Lengths are in units of the pupil's radius; the field is the tangent of the chief ray's angle in
x and y.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import InputError


@dataclass(frozen=True)
class Rim:
    """The projection of an opening, or of a row of openings, onto the pupil.

    Parameters
    ----------
    radius : float
        In units of the pupil's radius; at least 1 leaves the axial beam whole.
    shift : float
        Displacement along the field direction for a field of tangent 1; positive for rims behind
        the pupil, negative for those in front.
    members : int
        1: a hard edge; more: a soft one.
    """

    radius: float
    shift: float
    members: int = 1

    def __post_init__(self):
        """Check that radius and members are valid."""
        if not (np.isfinite(self.radius) and self.radius > 0.0 and np.isfinite(self.shift)):
            raise InputError(
                f"vignetting rim with radius {self.radius:g} and shift {self.shift:g}:"
                " the radius must be greater than 0, both must be finite"
            )
        if self.members < 1:
            raise InputError(f"vignetting rim has {self.members} members; give at least 1")


def cat_eye(strength, half_field_tangent, members=1):
    """Front and rear rim of a symmetric lens, from one slider.

    Parameters
    ----------
    strength : float
        0: none; 1: at the corner the rims have moved by the whole radius of the pupil.
    half_field_tangent : float
        Tangent of the field angle of the corner, > 0.
    members : int
        1 for a hard edge, more for a soft one.

    Returns
    -------
    tuple of Rim

    Raises
    ------
    InputError
        If the field is not positive.
    """
    if not half_field_tangent > 0.0:
        raise InputError(f"half field has tangent {half_field_tangent:g}; it must be above 0")
    shift = strength / half_field_tangent
    return Rim(1.0, -shift, members), Rim(1.0, shift, members)


def transmission(rims, points, field, width=0.0):
    """Transmittance of the rims at places of the pupil.

    Parameters
    ----------
    rims : sequence of Rim
    points : ndarray of shape (..., 2)
        In units of the pupil's radius.
    field : tuple of float
        Tangent of the chief ray's angle in x and y.
    width : float
        Side of the texel around each point, for antialiasing.

    Returns
    -------
    ndarray of shape (...)
        0 to 1; the pupil's own rim is not included.
    """
    points = np.asarray(points, dtype=float)
    field = np.asarray(field, dtype=float)
    passing = np.ones(points.shape[:-1])
    for rim in rims:
        # Edges of a row of members are as wide as members are apart: their sum has no steps.
        apart = np.hypot(*field) * abs(rim.shift) / rim.members if rim.members > 1 else 0.0
        edge = max(width, apart, 1e-12)
        cleared = 0.0
        for member in range(1, rim.members + 1):
            offset = points - field * (rim.shift * member / rim.members)
            inside = rim.radius - np.hypot(offset[..., 0], offset[..., 1])
            cleared = cleared + np.clip(0.5 + inside / edge, 0.0, 1.0)
        passing = passing * (cleared / rim.members)
    return passing
