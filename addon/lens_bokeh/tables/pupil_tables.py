"""The pupil of a real lens over the field: every ray that the lens accepts, in a few small tables.

A ray in front of a lens of revolution has three coordinates: the angle a of its direction to the
axis, and the place where it crosses the plane through the vertex of surface 1 and square to it (x,
and v in the meridional plane; see `addon.lens_bokeh.tables.pupil_box`). Tables over these three
hold where the ray lands on the sensor and with which slope, where it passes the stop, and how far
it stays inside the rims in front of and behind the stop. That is all that is needed for the pattern
of

- any point, at infinity or near: the rays of a near point differ in a, and each is looked up alone;
- any place of the sensor: landing places are affine in it;
- any f-number and iris: masks in stop coordinates;
- sharp vignetting: rims are the zeros of smooth functions, not masks.

The places are relative to a box that follows the pupil over the field. The box and the image
height of its centre are fine curves over a; the tables hold what is left and vary slowly, so that
a few fields, joined by local cubics, are enough.

Lens frame: light travels along (0, sin a, cos a), so that its image lies at +y; mm.
"""

from dataclasses import dataclass

import numpy as np

from .spline import cubic_taps

CHANNELS = (
    "image_x",  # on the sensor plane, mm
    "image_y",  # the same, less the image height of the box's centre
    "slope_x",  # dx/dz behind the lens
    "slope_y",
    "stop_x",  # on the stop, in units of its radius wide open
    "stop_y",
    "rim_1",  # 1 - radius / semi-diameter on a surface; negative is blocked
    "rim_2",
    "rim_3",
    "rim_others",  # the smallest over all other surfaces but the stop
    "transmission",  # Fresnel
)
# How the rays of another wavelength differ.
CHROMATIC_CHANNELS = CHANNELS[:4]
# Most rims with a channel of their own: each is a smooth function, but their minimum has kinks.
RIMS = slice(6, 10)
CURVES = ("image_height", "half_x", "centre_v", "half_v")

# The grid is wider than the passing rays by this share, so that rims lie well inside.
MARGIN = 0.08
# Change of sign of the channels when the picture is mirrored in x, and in y.
ODD_IN_X = np.array([-1, 1, -1, 1, -1, 1, 1, 1, 1, 1, 1.0])
_ODD_IN_Y = np.array([1, -1, 1, -1, 1, -1, 1, 1, 1, 1, 1.0])


@dataclass(frozen=True, eq=False)
class PupilTables:
    """Tables of one lens in one configuration.

    Parameters
    ----------
    curve_step : float
        Angle between samples of the curves, radians; the first is at 0.
    curves : ndarray of shape (K, 4)
        `CURVES` over the angle, mm.
    field_step : float
        Angle between tables, radians; the first one is at 0.
    tables : ndarray of float32, shape (F, N, N, 11)
        `CHANNELS`; rows along v, columns along x, both from -1 to 1 in units of
        ``(1 + MARGIN)`` half boxes.
    chromatic : ndarray of float32, shape (W, F, N, N, 4)
        `CHROMATIC_CHANNELS` at the further wavelengths, less those at the reference wavelength.
    wavelengths_nm : tuple of float
        The reference wavelength, then the W further ones.
    sensor : float
        z of the plane of `image_x`, `image_y`, mm from the vertex of surface 1.
    stop_radius : float
        mm, wide open.
    f_number, half_field_deg : float
        Nominal, wide open.
    """

    curve_step: float
    curves: np.ndarray
    field_step: float
    tables: np.ndarray
    chromatic: np.ndarray
    wavelengths_nm: tuple[float, ...]
    sensor: float
    stop_radius: float
    f_number: float
    half_field_deg: float

    def curves_at(self, angle):
        """Box and image height at angles.

        Parameters
        ----------
        angle : ndarray of shape (...)
            Radians, at least 0; beyond the curves their tangent goes on.

        Returns
        -------
        ndarray of shape (..., 4)
            `CURVES`.
        """
        taps, weights = cubic_taps(np.asarray(angle) / self.curve_step, len(self.curves))
        return np.einsum("t...,t...c->...c", weights, self.curves[taps])

    def look_up(self, angle, x, v, wavelength=0):
        """Look up where rays land, where they pass the stop, and their clearances of the rims.

        Parameters
        ----------
        angle, x, v : ndarray of shape (M,)
            Of the rays: radians, mm, mm.
        wavelength : int
            Index into `wavelengths_nm`.

        Returns
        -------
        ndarray of shape (M, 11)
            `CHANNELS`, with the full `image_y`.
        """
        height, half_x, centre, half_v = np.moveaxis(self.curves_at(angle), -1, 0)
        count = self.tables.shape[1]
        middle, reach = 0.5 * (count - 1), 1.0 + MARGIN
        at_x, at_v = x / (half_x * reach), (v - centre) / (half_v * reach)
        columns, wx = cubic_taps(np.clip(at_x, -1.0, 1.0) * middle + middle, count)
        rows, wv = cubic_taps(np.clip(at_v, -1.0, 1.0) * middle + middle, count)
        layers, wa = cubic_taps(angle / self.field_step + 1.0, len(self.tables) + 1)
        values = np.zeros((len(angle), len(CHANNELS)))
        # `take` from rows is several times as fast as an index an axis.
        flat = self.tables.reshape(-1, len(CHANNELS))
        further = self.chromatic[wavelength - 1].reshape(len(flat), -1) if wavelength > 0 else None
        for layer, weight_a in zip(layers, wa, strict=True):
            # Layer 0 is the first field on the other side of the axis: the mirror of layer 2.
            across = layer == 0
            mirrored = across.any()
            first = np.where(across, 1, layer - 1) * count
            part = np.zeros_like(values)
            for row, weight_v in zip(rows, wv, strict=True):
                start = (
                    first + (np.where(across, count - 1 - row, row) if mirrored else row)
                ) * count
                weight_av = weight_a * weight_v
                for column, weight_x in zip(columns, wx, strict=True):
                    weight = (weight_av * weight_x)[:, None]
                    part += weight * flat.take(start + column, axis=0)
                    if wavelength > 0:
                        part[:, :4] += weight * further.take(start + column, axis=0)
            if mirrored:
                part[across] *= _ODD_IN_Y
            values += part
        values[:, 1] += height
        # All that passes is inside the box: beyond the table rays are blocked.
        outside = np.maximum(np.maximum(np.abs(at_x), np.abs(at_v)) - 1.0, 0.0)
        beyond = outside > 0.0
        values[beyond, 9] = np.minimum(values[beyond, 9], 0.0) - outside[beyond]
        return values
