"""The thin lens: circle of confusion and its signs (methods 1).

With effective aperture radius `E`, focus distance `d_f` and depth `d` along the axis, a point seen
from the place `E v` on the lens (v in the unit disk) is displaced in the camera's xy plane by
`-R(d) v`, `R(d) = E (d_f - d) / d_f`: 0 at the focus plane, mirrored behind it. On the image,
with the field of view kept while focusing as Blender does, the signed radius in pixels is
`f_px E (d - d_f) / (d d_f)`: negative in front of the focus plane.

Depth of field is where the circle's diameter `c (1/d_f - 1/d)` stays below an acceptable one, `a`:
from `1 / (1/d_f + a/c)` to `1 / (1/d_f - a/c)`, infinitely far from the hyperfocal distance on.
With a parallel projection the diameter is `c (d/d_f - 1)`.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from ..errors import FocusError
from .iris import Iris


@dataclass(frozen=True)
class ThinLens:
    """A thin lens in the units of the scene.

    Parameters
    ----------
    aperture_radius : float
        Effective aperture radius, in m; 0 is a pinhole.
    focus_distance : float
        Along the optical axis, in m.
    iris : Iris
    """

    aperture_radius: float
    focus_distance: float
    iris: Iris = field(default_factory=Iris)

    def __post_init__(self):
        """Check that aperture, focus and iris can form a picture."""
        if not np.isfinite(self.focus_distance) or self.focus_distance <= 0.0:
            raise FocusError(
                f"focus distance is {self.focus_distance:g} m; it must be greater than 0"
                " (set a Focus Distance, or move the focus object out of the camera's plane)"
            )
        if not np.isfinite(self.aperture_radius) or self.aperture_radius < 0.0:
            raise FocusError(
                f"aperture radius is {self.aperture_radius:g} m; it must be finite and not negative"
            )
        if not np.isfinite(self.iris.ratio) or self.iris.ratio <= 0.0:
            raise FocusError(
                f"aperture ratio is {self.iris.ratio:g}; it must be greater than 0"
                " (camera > Depth of Field > Aperture > Ratio)"
            )


def aperture_radius(focal_length, f_number):
    """Effective aperture radius `F / (2 N#)`.

    Parameters
    ----------
    focal_length : float
        In m.
    f_number : float
        Focal length over entrance-pupil diameter.

    Returns
    -------
    float
        In m.

    Raises
    ------
    FocusError
        If `f_number` is not a positive finite number.
    """
    if not np.isfinite(f_number) or f_number <= 0.0:
        raise FocusError(f"f-stop is {f_number:g}; it must be greater than 0")
    return focal_length / (2.0 * f_number)


def coc_radius_px(depth, lens, focal_length_px):
    """Signed circle-of-confusion radius in the picture, the field of view kept.

    Parameters
    ----------
    depth : ndarray of shape (...)
        Along the optical axis, in m; positive.
    lens : ThinLens
    focal_length_px : float
        Focal length in pixels: what a length of 1 m at a depth of 1 m covers.

    Returns
    -------
    ndarray of shape (...)
        In pixels; negative in front of the focus plane.

    References
    ----------
    Potmesil and Chakravarty, SIGGRAPH 1981; Blender's camera focuses at a fixed field of view.
    """
    focus = lens.focus_distance
    return focal_length_px * lens.aperture_radius * (depth - focus) / (depth * focus)


def projected_areas(corners, focus_distance, extent, orthographic=False):
    """Return the areas of triangles from the lens' middle, and their mean over the lens.

    Seen from a place `v` on the lens, a point at depth `d` appears at ``p - v k``, with ``p`` where
    the pinhole shows it and ``k = 1/d - 1/f`` (with a parallel projection ``1 - d/f``), `f` the
    focus distance. The signed area of a triangle is therefore ``a + g . v``: it changes linearly
    over the lens, and its mean over the lens is the area from the middle, unless the plane of the
    triangle cuts the lens. Such a triangle is seen from the edge, and from both its sides.

    Parameters
    ----------
    corners : ndarray of shape (..., 3, 3)
        The three corners, in camera space, m; in front of the lens.
    focus_distance : float
        In m.
    extent : sequence of 2 float
        Half the width and height of the opening, an ellipse, m.
    orthographic : bool
        A parallel projection.

    Returns
    -------
    middle, mean : ndarray of shape (...)
        On a plane at unit distance, or across the projection, in m^2; front and back facing alike.
    """
    depth = -corners[..., 2:]
    if orthographic:
        place, moves = corners[..., :2], 1.0 - depth / focus_distance
    else:
        place, moves = corners[..., :2] / depth, 1.0 / depth - 1.0 / focus_distance
    u, w = (place[..., i, :] - place[..., 0, :] for i in (1, 2))
    alpha, beta = (moves[..., i, :] - moves[..., 0, :] for i in (1, 2))
    middle = 0.5 * np.abs(u[..., 0] * w[..., 1] - u[..., 1] * w[..., 0])
    turned = 0.5 * (beta * u - alpha * w)
    # Largest change over the lens.
    change = np.hypot(turned[..., 1] * extent[0], turned[..., 0] * extent[1])
    cut = middle < change
    share = np.where(cut, middle, 0.0) / np.maximum(change, 1e-300)
    return middle, np.where(cut, change * _mean_distance(share), middle)


def _mean_distance(c):
    """Return the mean of ``|c + x|`` over a unit disk, for c from 0 to 1."""
    root = np.sqrt(1.0 - c**2)
    return 2.0 / np.pi * (c * np.arcsin(c) + root * (c**2 + 2.0) / 3.0)


@dataclass(frozen=True)
class DepthOfField:
    """How a thin lens blurs along the optical axis.

    Parameters
    ----------
    focus_distance : float
        In m.
    reach : float
        Diameter of the circle of confusion, in pixels of the picture: times m at an unbounded
        distance, for a parallel projection at twice the focus distance.
    orthographic : bool
    """

    focus_distance: float
    reach: float
    orthographic: bool = False

    def diameter(self, depth):
        """Return the signed diameter of the circle of confusion, in pixels.

        Parameters
        ----------
        depth : float or ndarray
            Along the optical axis, m; positive.

        Returns
        -------
        float or ndarray
            Negative in front of the focus plane.
        """
        if self.orthographic:
            return self.reach * (depth / self.focus_distance - 1.0)
        return self.reach * (1.0 / self.focus_distance - 1.0 / depth)

    def limits(self, acceptable):
        """Return the nearest and the farthest depth that are acceptably sharp, in m.

        Parameters
        ----------
        acceptable : float
            Diameter of the circle of confusion, in pixels; positive.

        Returns
        -------
        near, far : float
            The second is infinite where there is no limit.
        """
        focus = self.focus_distance
        if self.reach <= 0.0:
            return 0.0, math.inf
        share = acceptable / self.reach
        if self.orthographic:
            return max(0.0, focus * (1.0 - share)), focus * (1.0 + share)
        behind = 1.0 / focus - share
        return 1.0 / (1.0 / focus + share), 1.0 / behind if behind > 0.0 else math.inf


def depth_of_field(lens, pixels_per_unit, orthographic=False):
    """Return the `DepthOfField` of a thin lens.

    Parameters
    ----------
    lens : ThinLens
    pixels_per_unit : float
        Pixels that a length of 1 m covers at a depth of 1 m, with a parallel projection anywhere.
    orthographic : bool

    Returns
    -------
    DepthOfField
    """
    reach = 2.0 * lens.aperture_radius * pixels_per_unit
    return DepthOfField(lens.focus_distance, reach, orthographic)
