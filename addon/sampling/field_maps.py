"""Maps over the field of the picture: how much of an aberration a place gets.

A place of the field is its tilt `t`, 0 on the optical axis and 1 in the outermost corner of the
picture, and its angle `theta` around the axis, in radians from the picture's x axis, anticlockwise.
A map is two atoms one after the other, `M(t, theta) = g(f(t, theta), theta)`: the second takes what
the first gives (Jeong's dissertation, equation 4.9). Where an atom grows without bound its value is
clamped to `LIMIT`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import InputError

# Beyond a hundredth of the field from its pole, 1 / t is not touched. More would turn the picture
# inside out at strengths that are used, and 32 bit floats keep five digits of what is left.
LIMIT = 100.0
# Number of values of a drawn curve: as many straight pieces as Blender's own curve tables have.
CURVE_POINTS = 257
LINEAR_CURVE = (0.0, 1.0)

# Atoms and their labels, in the order of the menu. The last but one is ours: cos(theta) is not
# continuous on the axis, t cos(theta) is.
ATOMS = {
    "IDENTITY": "t",
    "T2": "t\u00b2",
    "T3": "t\u00b3",
    "EXP": "exp(t)",
    "ONE_MINUS": "1 \u2212 t",
    "RECIPROCAL": "1/t",
    "COS_T": "cos(2\u03c0t)",
    "COS_THETA": "cos(\u03b8)",
    "T_COS_THETA": "t cos(\u03b8)",
    "CURVE": "Curve",
}
_ANGULAR = frozenset({"COS_THETA", "T_COS_THETA"})


@dataclass(frozen=True)
class FieldMap:
    """Two atoms, one after the other.

    Parameters
    ----------
    f, g : str
        Names out of `ATOMS`; `f` is taken first.
    curve_f, curve_g : tuple of float
        Values of the drawn curves, evenly spread over arguments from 0 to 1, straight in between
        and level beyond; at least two. Only used by an atom ``"CURVE"``.
    """

    f: str = "IDENTITY"
    g: str = "IDENTITY"
    curve_f: tuple[float, ...] = LINEAR_CURVE
    curve_g: tuple[float, ...] = LINEAR_CURVE

    def __post_init__(self):
        """Check that the atoms and curves are valid."""
        for name in (self.f, self.g):
            if name not in ATOMS:
                raise InputError(f"field map has no atom '{name}'; use one of {', '.join(ATOMS)}")
        for curve in (self.curve_f, self.curve_g):
            if len(curve) < 2 or not np.all(np.isfinite(curve)):
                raise InputError("a field map's curve needs two or more values, all finite")

    def __call__(self, t, theta=0.0):
        """Evaluate the map.

        Parameters
        ----------
        t : array_like of shape (...)
            Tilt; taken as 1 outside the picture.
        theta : array_like of shape (...)
            In radians.

        Returns
        -------
        ndarray of shape (...)
            float64 in [-LIMIT, LIMIT].
        """
        return self._evaluate(t, theta)[0]

    def clamped_at(self, t, theta=0.0):
        """Return where the value is clamped to the limit.

        Parameters
        ----------
        t, theta : array_like of shape (...)

        Returns
        -------
        ndarray of shape (...)
            bool.
        """
        return self._evaluate(t, theta)[1]

    @cached_property
    def clamped(self):
        """Whether the map is clamped anywhere in the picture."""
        t = np.linspace(0.0, 1.0, 513)
        theta = np.linspace(-np.pi, np.pi, 33 if self.is_angular else 1)[:, None]
        return bool(self.clamped_at(t, theta).any())

    @property
    def is_angular(self):
        """Whether the map varies around the axis."""
        # cos(theta) as the second atom leaves nothing of the first.
        return self.g in _ANGULAR or self.f in _ANGULAR

    @property
    def text(self):
        """The map as a formula, for messages and panels."""
        return composed_text(self.f, self.g)

    def table(self, size_t=256, size_theta=128):
        """Tabulate the map for the graphics device.

        Parameters
        ----------
        size_t : int
            Columns: tilts from 0 to 1, both included.
        size_theta : int
            Rows: angles from -pi to pi, both included; a map that does not vary around the axis
            has one row however many are asked for.

        Returns
        -------
        ndarray of shape (size_theta or 1, size_t)
            float32.
        """
        t = np.linspace(0.0, 1.0, size_t)
        theta = np.linspace(-np.pi, np.pi, size_theta) if self.is_angular else np.zeros(1)
        return self(t[None, :], theta[:, None]).astype(np.float32)

    def _evaluate(self, t, theta):
        t, theta = np.broadcast_arrays(np.clip(t, 0.0, 1.0), np.asarray(theta, np.float64))
        inner, inner_clamped = _atom(self.f, t.astype(np.float64), theta, self.curve_f)
        outer, outer_clamped = _atom(self.g, inner, theta, self.curve_g)
        return outer, inner_clamped | outer_clamped


def _atom(name, value, theta, curve):
    """Return an atom's value, and where it is clamped."""
    with np.errstate(divide="ignore", over="ignore"):
        if name == "T2":
            result = value**2
        elif name == "T3":
            result = value**3
        elif name == "EXP":
            result = np.exp(np.minimum(value, LIMIT))
        elif name == "ONE_MINUS":
            result = 1.0 - value
        elif name == "RECIPROCAL":
            # Whatever the sign of a zero: a tilt comes from the positive side.
            result = 1.0 / (value + 0.0)
        elif name == "COS_T":
            result = np.cos(2.0 * np.pi * value)
        elif name == "COS_THETA":
            result = np.cos(theta)
        elif name == "T_COS_THETA":
            result = value * np.cos(theta)
        elif name == "CURVE":
            result = np.interp(value, np.linspace(0.0, 1.0, len(curve)), curve)
        else:
            result = value
    return np.clip(result, -LIMIT, LIMIT), np.abs(result) > LIMIT


def composed_text(f, g):
    """Return two atoms as one formula.

    Parameters
    ----------
    f, g : str
        Names out of `ATOMS`.

    Returns
    -------
    str
        Such as ``1/(1 - t)`` for ``ONE_MINUS`` and ``RECIPROCAL``.
    """
    inner = "curve(t)" if f == "CURVE" else ATOMS[f]
    if g == "IDENTITY":
        return inner
    if g == "COS_THETA":
        return ATOMS[g]
    if g == "CURVE":
        return f"curve({inner})"
    if g == "EXP":
        return f"exp({inner})"
    if g == "COS_T":
        return ATOMS[g] if f == "IDENTITY" else f"cos(2\u03c0 ({inner}))"
    # Sums and fractions need brackets, and powers under powers.
    open_term = f in {"ONE_MINUS", "RECIPROCAL", "T_COS_THETA"}
    wrapped = f"({inner})" if open_term or (f in {"T2", "T3"} and g in {"T2", "T3"}) else inner
    patterns = {
        "T2": "{}\u00b2",
        "T3": "{}\u00b3",
        "ONE_MINUS": "1 \u2212 {}",
        "RECIPROCAL": "1/{}",
        "T_COS_THETA": "{} cos(\u03b8)",
    }
    return patterns[g].format(wrapped)


STANDARD = FieldMap()
# Name, axial map, lateral map. "Standard" and "Showcase" are those of the dissertation's figure
# 4.9. Five are what its text tells of figure 4.10 a to e, whose maps are only drawn there: spread
# from the centre, decreasing and negative, steep with angular, angular with exponential, linear
# with angular. "Centre" is its example exp(1 - t).
FIELD_PRESETS = {
    "STANDARD": ("Standard", FieldMap(), FieldMap()),
    "SHOWCASE": (
        "Showcase",
        FieldMap("ONE_MINUS", "RECIPROCAL"),
        FieldMap("ONE_MINUS", "RECIPROCAL"),
    ),
    "SPREAD": ("Spread", FieldMap("T2"), FieldMap("T2", "EXP")),
    "REVERSED": ("Reversed", FieldMap("ONE_MINUS"), FieldMap("EXP", "ONE_MINUS")),
    "STEEP": ("Steep", FieldMap("EXP"), FieldMap("COS_THETA")),
    "WHEEL": ("Wheel", FieldMap("COS_THETA"), FieldMap("EXP")),
    "BUTTERFLY": ("Butterfly", FieldMap(), FieldMap("T_COS_THETA")),
    "CENTRE": ("Centre", FieldMap("T3"), FieldMap("ONE_MINUS", "EXP")),
    "RINGS": ("Rings", FieldMap("COS_T"), FieldMap("COS_T")),
}


def field_corner(projection, orthographic=False):
    """Return how far out the outermost corner of a picture is.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the whole picture, OpenGL convention.
    orthographic : bool

    Returns
    -------
    float
        Angle of its chief ray with the axis, in radians; its distance from the axis in m for an
        orthographic camera, whose chief rays do not tilt.
    """
    corners = np.array([[x, y, -1.0, 1.0] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    points = corners @ np.linalg.inv(np.asarray(projection, np.float64)).T
    return float(_tilt(points[:, :3] / points[:, 3:], orthographic).max())


def _tilt(points, orthographic):
    away = np.hypot(points[..., 0], points[..., 1])
    return away if orthographic else np.arctan2(away, -points[..., 2])
