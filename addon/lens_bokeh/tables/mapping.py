"""Focus, object depth and f-number to a pattern of the profile.

Distances are told from the first principal plane H of the focused lens, positive before it, in mm.
Focused at d_f the sensor stands in the paraxial image of d_f at the reference wavelength.

**Exact way.** The ray map is read at the object's vergence, cut at the stop fraction N0 / N (or
where another rim blocks), and laid out on the sensor's plane: `pattern_row`.

**Texture for a shader.** Focus and f-number are the same for a whole frame, so only depth is left:
`frame_table` lays out rows over depth. The signed paraxial circle of confusion on the sensor is
linear in the object's vergence, ``c(V) = k0 + k1 V`` (positive behind focus, where the pattern is
point-mirrored). Patterns keep their shape far from focus and change fast near it, so the rows are
even in ``w = c / (|c| + c0)``, with c0 the blur that the aberrations leave in focus. A shader does

    V = 1 / (d + pupil_offset)           d: distance of the highlight from H
    c = k0 + k1 V;  w = c / (|c| + c0)
    v = (w - first_w) / (last_w - first_w)      0 to 1 from the first row's centre to the last's
    R = extent_tx(v) * (|c| + c0)               mm on the sensor
    density = table_tx(r / R, v) / R^2          per mm^2; integrates to 1 over the sprite

with r the distance from the sprite's centre and linear filtering. Texel j of `extent_tx` and of the
rows stands at v = j / (rows - 1), texel i of the radii at ``r / R = (i + 0.5) / radii``. Both
textures are smooth: R / (|c| + c0) stays between about 0.1 and 1.1.

**Paper's way** (equation 8): `equivalent_image_distance` gives the row of the table for the
reference object whose circle of confusion is the same.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import FocusError
from .profile import REFERENCE_DISTANCE, row_of_fan

# Rays of a row: a finer fan changes nothing in a pattern of 1024 rings.
_RAYS = 1025
# Least c0, mm: smaller than any pixel.
_LEAST_BLUR = 1.0e-4


@dataclass(frozen=True)
class FrameTable:
    """Patterns over object depth at one focus and f-number: what a shader samples.

    Parameters
    ----------
    density : ndarray of float32, shape (rows, radii, channels)
        Each row integrates to 1 over the unit disk.
    extents : ndarray of float32, shape (rows,)
        R / (|c| + c0).
    blur : tuple of float
        k0 in mm and k1 in mm^2 of ``c = k0 + k1 V``.
    soft_blur : float
        c0, mm.
    pupil_offset : float
        mm, from H to the entrance pupil: ``V = 1 / (d + pupil_offset)``.
    w_range : tuple of float
        w of the first and of the last row.
    """

    density: np.ndarray
    extents: np.ndarray
    blur: tuple[float, float]
    soft_blur: float
    pupil_offset: float
    w_range: tuple[float, float]

    def row_position(self, object_distance):
        """Texture coordinate and scale of an object's pattern, as a shader computes them.

        Parameters
        ----------
        object_distance : float
            From H, mm.

        Returns
        -------
        position : float
            v, 0 to 1.
        scale : float
            |c| + c0, mm.
        """
        c = self.blur[0] + self.blur[1] / (object_distance + self.pupil_offset)
        scale = abs(c) + self.soft_blur
        first, last = self.w_range
        return float(np.clip((c / scale - first) / (last - first), 0.0, 1.0)), scale

    def sample(self, object_distance):
        """Read the table as a shader with linear filtering does.

        Parameters
        ----------
        object_distance : float
            From H, mm.

        Returns
        -------
        extent : float
            mm on the sensor.
        density : ndarray of shape (radii, channels)
        """
        position, scale = self.row_position(object_distance)
        place = position * (len(self.extents) - 1)
        low = min(int(place), len(self.extents) - 2)
        t = place - low
        extent = ((1.0 - t) * self.extents[low] + t * self.extents[low + 1]) * scale
        return float(extent), (1.0 - t) * self.density[low] + t * self.density[low + 1]


def pattern_row(profile, object_distance, focus_distance, f_number, radii=1024):
    """Pattern of a point on the sensor, for any depth, focus and f-number.

    Parameters
    ----------
    profile : LensProfile
    object_distance : float
        From H, mm; inf is allowed. Before the nearest object of the ray map (see
        `ray_map.nearest_object`) the aberrations are those of the nearest.
    focus_distance : float
        From H, mm; inf is allowed.
    f_number : float
        Smaller than wide open counts as wide open.
    radii : int

    Returns
    -------
    PatternRow
        ``row.extent`` is the radius in mm, ``row.density`` has shape (radii, channels).

    Raises
    ------
    FocusError
        If the lens cannot be focused there.
    InputError
        If the object is not before the entrance pupil, or the f-number is not positive.
    """
    state = profile.focused(focus_distance)
    shift = state.image_plane(focus_distance) - state.ray_map.plane
    vergence = state.vergence(object_distance)
    fan = state.ray_map.rays(vergence, profile.stop_fraction(f_number), _RAYS)
    return row_of_fan(fan, shift, profile.color, radii)


def frame_table(profile, focus_distance, f_number, rows=512, radii=512, nearest=None):
    """Patterns over depth at one focus and f-number, for a shader.

    Parameters
    ----------
    profile : LensProfile
    focus_distance : float
        From H, mm; inf is allowed.
    f_number : float
    rows, radii : int
    nearest : float or None
        Distance from H of the nearest object, mm; None: the nearest of the ray map.

    Returns
    -------
    FrameTable

    Raises
    ------
    FocusError, InputError
        As `pattern_row`.
    """
    state = profile.focused(focus_distance)
    ray_map = state.ray_map
    opening = profile.stop_fraction(f_number)
    shift = state.image_plane(focus_distance) - ray_map.plane
    linear = ray_map.reference[0] + shift * ray_map.reference[1]
    # Light of far objects has crossed the axis before it reaches the sensor.
    blur = tuple((-opening * ray_map.pupil_radius * linear).tolist())
    height, slope, _ = ray_map.rays(state.vergence(focus_distance), opening, 65)
    in_focus = np.abs(height + shift * slope).max()
    soft = max(float(in_focus), _LEAST_BLUR)
    last = float(ray_map.vergences[-1])
    if nearest is not None:
        last = state.vergence(nearest)
    ends = [blur[0] + blur[1] * v for v in (0.0, last)]
    w_range = tuple(c / (abs(c) + soft) for c in ends)
    density = np.empty((rows, radii, profile.channels), np.float32)
    extents = np.empty(rows, np.float32)
    for i, w in enumerate(np.linspace(*w_range, rows)):
        c = soft * w / (1.0 - abs(w))
        vergence = max((c - blur[0]) / blur[1], 0.0)
        row = row_of_fan(ray_map.rays(vergence, opening, _RAYS), shift, profile.color, radii)
        density[i] = row.density
        extents[i] = row.extent / (abs(c) + soft)
    return FrameTable(density, extents, blur, soft, ray_map.pupil - state.first_order.h, w_range)


def equivalent_image_distance(
    profile, object_distance, focus_distance, reference_distance=REFERENCE_DISTANCE
):
    """Row of the paper's table with the same circle of confusion.

    Solving ``C(d', d_f) = C(d_r, d_f')`` for d_f' and putting it into ``u = d F / (d - F)`` gives
    ``u(d_f') = u(d_r) (1 + F (d' - d_f) / ((d_f - F) d'))``: linear, and finite where d_f' is not.

    Parameters
    ----------
    profile : LensProfile
    object_distance, focus_distance, reference_distance : float
        d', d_f, d_r from H, mm; inf is allowed for the first two.

    Returns
    -------
    image_distance : float
        u(d_f') from H', mm.
    scale : float
        Circle of confusion over effective lens radius, ``C / E``; negative before the focus.

    Raises
    ------
    FocusError
        If the focus or the reference is not beyond the focal length.

    References
    ----------
    Jeong et al. 2020, equations 6 to 8.
    """
    focal = profile.states[0].first_order.efl
    for what, distance in (("focus", focus_distance), ("reference", reference_distance)):
        if not distance > focal:
            raise FocusError(
                f"{what} distance {distance:g} mm is not beyond the focal length {focal:g} mm"
            )
    # In reciprocals, so that infinity is a number like others.
    nearness, focus_nearness = 1.0 / object_distance, 1.0 / focus_distance
    scale = focal * (focus_nearness - nearness) / (1.0 - focal * focus_nearness)
    reference_image = reference_distance * focal / (reference_distance - focal)
    return reference_image * (1.0 + scale), scale
