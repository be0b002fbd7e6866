"""Beams of a real lens over field and vergence, for the tiles of its discs."""

from functools import cache

import numpy as np

from ..tables.pupil_beam import (
    beam_from_infinity,
    beam_from_point,
    box_from_infinity,
    box_from_point,
)
from ..tables.ray_map import lagrange_weights
from ..tables.spline import spline_matrix
from ..tables.undistorted import undistorted
from .tile_drawing import RAYS, HalfGrid

FIELDS = 9
_VERGENCES = 7
# Terms that the scale of the picture changes by over the field; fields that tell distortion.
_SCALE_TERMS, _LEAST_FIELDS = 3, 4


class PupilBeams:
    """Beams of a lens at an f-number over field and vergence.

    Rays are lines behind the lens: the same beams serve all places of the sensor. They are traced
    by `traced`.

    Parameters
    ----------
    tables : PupilTables
    pupil : float
        z of the entrance pupil, mm from surface 1.
    f_number : float
    largest_tangent : float
        Of the field angle wanted.
    largest_vergence : float
        1 / distance from the entrance pupil of the nearest point, 1/mm.

    Attributes
    ----------
    tangents : ndarray of shape (FIELDS,)
    sensor : float
        z of the sensor plane of the tables, mm.
    """

    def __init__(self, tables, pupil, f_number, largest_tangent, largest_vergence):
        limit = np.tan(min(np.radians(tables.half_field_deg), 1.5))
        self.tangents = np.linspace(0.0, min(largest_tangent, limit), FIELDS)
        turn = np.linspace(0.0, np.pi, _VERGENCES)
        self.sensor = tables.sensor
        self._nodes = largest_vergence * 0.5 * (1.0 - np.cos(turn))
        self._image, self._rest = [], []
        self._beam = tables, pupil, f_number

    def traced(self):
        """Trace what is not yet traced, field by field.

        Yields
        ------
        None
            After each field.
        """
        tables, pupil, f_number = self._beam
        while len(self._image) < FIELDS:
            tangent = self.tangents[len(self._image)]
            points = [_point(pupil, tangent, vergence) for vergence in self._nodes]
            ends = [points[k] for k in (0, _VERGENCES // 2, -1)]
            sides = np.array([_box(tables, point, f_number) for point in ends]).T
            # One grid for all: a ray of the grid is then a smooth function of the vergence.
            box = (sides[0].min(), sides[1].max(), sides[2].min(), sides[3].max())
            beams = [_traced(tables, point, f_number, box) for point in points]
            scale = beams[0].stop_scale
            image = [np.concatenate([b.image, b.slope], axis=-1) for b in beams]
            rest = [
                np.concatenate([b.stop / scale, b.weight[..., None], b.rims], axis=-1)
                for b in beams
            ]
            self._rest.append(np.array(rest, np.float32))
            self._image.append(np.array(image))
            yield

    def distorted(self, shift, vergence):
        """Return where points in focus are drawn, to be taken away from the patterns.

        Parameters
        ----------
        shift : float
            As of `grids`.
        vergence : float
            Of the focus, 1/mm.

        Returns
        -------
        scale : float
            Of the picture near its axis, mm a tangent.
        pairs : ndarray of shape (FIELDS, 2)
            As `undistorted` has them; fewer where the lens turns the picture back.
        """
        (mix,), _ = self._mixed([vergence])
        heights = []
        for image, rest in zip(self._image, self._rest, strict=True):
            column = image.shape[2] // 2
            landing = image[..., column, 1] + image[..., column, 3] * shift
            heights.append(_at_zero(mix @ rest[..., column, 1].astype(float), mix @ landing))
        tangents, heights = self.tangents[1:], np.array(heights[1:])
        scale = np.polyfit(tangents**2, heights / tangents, _SCALE_TERMS)[-1]
        pairs = np.column_stack([self.tangents, np.append(0.0, heights / scale)])
        falling = np.flatnonzero(np.diff(pairs[:, 1]) <= 0.0)
        return float(scale), pairs[: falling[0] + 1] if len(falling) else pairs

    def _mixed(self, vergences):
        count = len(self._nodes)
        return np.array([lagrange_weights(self._nodes, v, count)[0] for v in vergences]), count

    def grids(self, field, vergences, shift, distorted=None):
        """Return the rays of a field's beams on a fine grid.

        Parameters
        ----------
        field : int
        vergences : sequence of float
        shift : float
            Sensor's distance behind the sensor plane of the tables, mm.
        distorted : tuple or None
            Of `distorted`: the picture is straightened by it.

        Returns
        -------
        grids : list of HalfGrid
            y is relative to `centers`.
        centers : ndarray of shape (V,)
            Where the rays through the middle of the stop land: the points' pinhole pictures, mm
            from an origin that is the same for all.
        """
        mix, count = self._mixed(vergences)
        image = self._image[field]
        landing = image[..., :2] + image[..., 2:] * shift
        if distorted is not None and len(distorted[1]) >= _LEAST_FIELDS:
            scale, pairs = distorted
            away = np.hypot(landing[..., 0], landing[..., 1]) / abs(scale)
            straight = undistorted(pairs, away.ravel()).reshape(away.shape)
            landing *= (straight / np.maximum(away, 1e-12))[..., None]
        side = landing.shape[1]
        # The meridional column of rays.
        heights = mix @ landing[:, :, side // 2, 1]
        stops = mix @ self._rest[field][:, :, side // 2, 1].astype(float)
        centers = np.array([_at_zero(*pair) for pair in zip(stops, heights, strict=True)])
        # 32 bits are enough for what is near the origin.
        landing[..., 1] -= centers.mean()
        coarse = np.concatenate([landing.astype(np.float32), self._rest[field]], axis=-1)
        mix = mix.astype(np.float32)
        if len(mix) < count:
            # Mixing and refining may change places: what is fewer is refined.
            coarse = np.tensordot(mix, coarse, axes=1)
            count, mix = len(mix), np.eye(len(mix), dtype=np.float32)
        rows = _refining(side)
        fine = np.tensordot(rows[RAYS // 2 :], coarse, axes=(1, 2))
        fine = np.tensordot(rows, fine, axes=(1, 2))
        # rows, columns, nodes, channels
        fine = np.ascontiguousarray(fine.transpose(2, 3, 0, 1))
        channels, shape = fine.shape[1], fine.shape[2:]
        mixed = mix @ fine.reshape(count, -1)
        grids = []
        for part in mixed.reshape(-1, channels, *shape):
            x, y, stop_x, stop_y, weight, *rims = part
            grids.append(HalfGrid(x, y, stop_x, stop_y, tuple(rims), np.maximum(weight, 0.0)))
        return grids, centers - centers.mean()

    def width_in_focus(self, shift, vergence):
        """Return the largest half width of a focused point's patterns over the fields, mm."""
        distorted, widths = self.distorted(shift, vergence), []
        for field in range(FIELDS):
            grids, _ = self.grids(field, np.array([vergence]), shift, distorted)
            widths += grids[0].bounds()[1:]
        return float(max(widths))


# Memo of the count alone, which is a constant.
@cache
def _refining(count):
    """Matrix of a spline from a grid's rays to the middles of `RAYS` cells."""
    at = (np.arange(RAYS) + 0.5) / RAYS * (count - 1)
    return spline_matrix(np.arange(count), at).astype(np.float32)


def _point(pupil, tangent, vergence):
    """Height and depth before surface 1 of a point, mm; its tangent alone at infinity."""
    if vergence * 1e7 < 1.0:
        return (float(np.arctan(tangent)),)
    distance = 1.0 / vergence
    return (tangent * distance, distance - pupil)


def _box(tables, point, f_number):
    find = box_from_infinity if len(point) == 1 else box_from_point
    return find(tables, *point, f_number)


def _traced(tables, point, f_number, box):
    trace = beam_from_infinity if len(point) == 1 else beam_from_point
    return trace(tables, *point, f_number, box=box)


def _at_zero(stop, height):
    """Height where the ray through the middle of the stop lands."""
    near = np.argsort(np.abs(stop))[:9]
    # A vignetted pupil may end before the middle of the stop.
    return float(np.polyval(np.polyfit(stop[near], height[near], 2), 0.0))
