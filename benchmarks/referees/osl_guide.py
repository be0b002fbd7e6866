"""Where rays that start on a part of the sensor must go to meet a small lamp: boxes for `osl_lens`.

A lamp as small as a point is met by so few of all rays through a lens that a picture of it would
take billions. Rays from the sensor are traced through a grid of places behind the lens; where they
pass the lamp farther than half the distance of their neighbours, no ray between them meets it. The
box of the other places is all that has to be sampled: found first for squares of pixels, then,
within these boxes, for each pixel. The light is the same with and without boxes, only the noise is
not.
"""

import numpy as np

from addon.optics.glass import REFERENCE_WAVELENGTH_NM
from addon.optics.rays.trace import trace

from .osl_lens import rays_from_sensor

# Pixels along the side of a square, places along the side of its grid, and of that of a pixel.
SQUARE = 4
_COARSE, _FINE = 32, 24
# A lamp is met within so many of its radii, and a pixel reaches so many of its sides from its
# middle: with some margin for what lenses do to sizes.
_NEAR, _REACH = 1.1, 0.9
# Pixels at a time.
_PART = 512


def boxes(lens, point, radius, film, focal_length):
    """Find the boxes of a lamp.

    Parameters
    ----------
    lens : OslLens
    point : sequence of 3 float
        Middle of the lamp in the camera's frame: right, up, towards the scene, m.
    radius : float
        Of the lamp, m.
    film : tuple of 2 ndarray
        x and y of the pixels' edges in the picture, mm of the camera's sensor, rising; one more
        than a multiple of `SQUARE`.
    focal_length : float
        Of the camera, mm.

    Returns
    -------
    ndarray of float32, shape (len(y) - 1, len(x) - 1, 4)
        x0, x1, y0, y1 over `aim_radius`; all 0 where nothing meets the lamp.
    """
    x, y = (np.asarray(edges) * (lens.scale / focal_length) for edges in film)
    pixel = abs(x[1] - x[0])
    lamp = _Lamp(lens, point, radius)
    corners = np.stack(np.meshgrid(x[::SQUARE], y[::SQUARE]), axis=-1)
    whole = np.broadcast_to([-1.0, 1.0, -1.0, 1.0], (*corners.shape[:2], 4))
    found = lamp.boxes(corners, whole, _COARSE, _REACH * SQUARE * pixel)
    joined = _joined(found)
    blocks = np.repeat(np.repeat(joined, SQUARE, axis=0), SQUARE, axis=1)
    middles = np.stack(np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2), axis=-1)
    used = blocks[..., 0] < blocks[..., 1]
    result = np.zeros(blocks.shape, np.float32)
    fine = lamp.boxes(middles[used], blocks[used], _FINE, _REACH * pixel)
    fine[fine[:, 0] >= fine[:, 1]] = 0.0
    result[used] = fine
    return result


def _joined(found):
    """Boxes of squares from those of their corners."""
    corners = np.stack([found[:-1, :-1], found[1:, :-1], found[:-1, 1:], found[1:, 1:]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    return np.stack([low[..., 0], high[..., 1], low[..., 2], high[..., 3]], axis=-1)


class _Lamp:
    def __init__(self, lens, point, radius):
        self._lens = lens
        self._place = np.array([point[0], point[1], lens.pupil / 1000.0 - point[2]]) * 1000.0
        self._radius = radius * 1000.0
        self._depth = point[2] * 1000.0

    def boxes(self, sensor, within, count, reach):
        """Boxes of places on the sensor, `reach` mm round each, inside of given ones.

        Where there is none, x0 is above x1.
        """
        shape = sensor.shape[:-1]
        sensor, within = sensor.reshape(-1, 2), within.reshape(-1, 4)
        parts = [
            self._boxes(sensor[i : i + _PART], within[i : i + _PART], count, reach)
            for i in range(0, len(sensor), _PART)
        ]
        return np.concatenate([*parts, np.empty((0, 4))]).reshape(*shape, 4)

    def _boxes(self, sensor, within, count, reach):
        share = np.linspace(0.0, 1.0, count)
        u = within[:, :1] * (1.0 - share) + within[:, 1:2] * share
        v = within[:, 2:3] * (1.0 - share) + within[:, 3:] * share
        shape = (len(sensor), count, count)
        place = np.stack(
            [np.broadcast_to(u[:, None, :], shape), np.broadcast_to(v[:, :, None], shape)], axis=-1
        )
        lens = self._lens
        rays = rays_from_sensor(
            np.repeat(sensor, count * count, axis=0), place.reshape(-1, 2) * lens.aim_radius,
            lens.configuration.sensor, lens.aim,
        )  # fmt: skip
        found = trace(lens.configuration, rays, REFERENCE_WAVELENGTH_NM, clip=False, backwards=True)
        along = (self._place[2] - found.points[:, 2]) / found.directions[:, 2]
        past = found.points[:, :2] + along[:, None] * found.directions[:, :2] - self._place[:2]
        past = np.where(found.reached[:, None], past, np.nan).reshape(*shape, 2)
        slack = reach * self._depth / abs(lens.scale) + _apart(past)
        with np.errstate(invalid="ignore"):
            near = np.hypot(past[..., 0], past[..., 1]) < _NEAR * self._radius + slack
        near &= _grown(found.passed.reshape(shape))
        return _spans(near, u, v)


def _apart(past):
    """How far half way to the neighbours is, shape (N, n, n)."""
    result = np.zeros(past.shape[:-1])
    for axis in (1, 2):
        step = np.nan_to_num(np.linalg.norm(np.diff(past, axis=axis), axis=-1))
        step = np.moveaxis(step, axis, 0)
        largest = np.zeros((len(step) + 1, *step.shape[1:]))
        largest[:-1] = step
        largest[1:] = np.maximum(largest[1:], step)
        result += 0.5 * np.moveaxis(largest, 0, axis)
    return result


def _grown(open_):
    """Add to places of a grid all their neighbours; shape (N, n, n)."""
    for axis in (1, 2):
        moved = np.moveaxis(open_, axis, 0)
        result = moved.copy()
        result[1:] |= moved[:-1]
        result[:-1] |= moved[1:]
        open_ = np.moveaxis(result, 0, axis)
    return open_


def _spans(near, u, v):
    """Boxes round the places that are near and a step more, one for each grid."""
    result = np.empty((len(near), 4))
    rows = np.arange(len(near))
    last = near.shape[1] - 1
    for axis, places, first in ((1, u, 0), (2, v, 2)):
        met = near.any(axis=axis)
        low = np.maximum(met.argmax(axis=1) - 1, 0)
        high = np.minimum(last - met[:, ::-1].argmax(axis=1) + 1, last)
        result[:, first], result[:, first + 1] = places[rows, low], places[rows, high]
    result[~near.any(axis=(1, 2))] = (np.inf, -np.inf, np.inf, -np.inf)
    return result
