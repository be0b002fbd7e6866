"""Tiles: bokeh patterns of a real lens over field and depth, for the splat.

Each tile is the traced pattern of a point (`lens_bokeh.tables.pupil_beam`) at a field and a depth,
in the meridional frame: the picture's azimuth of the point is +y. It holds the light, and for each
of its texels the place in the stop that the light has come through, so that an iris of any shape
can be laid over it at any azimuth. A tile spans its pattern, wherever that lies: tiles of
neighbouring fields and depths can be mixed texel by texel while places and sizes are mixed as
numbers.

Fields are even in the tangent of the angle, depths even in w (`lens_bokeh.tables.mapping`). Tiles
carry unit light: what vignetting takes from the energy is left out, as it is for the rest of the
picture. Beams are traced for a few vergences and interpolated.
"""

from dataclasses import dataclass
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
from .opening import LEAST_BLUR, extent
from .tile_drawing import RAYS, STOP_OFFSET, STOP_SCALE, HalfGrid, blur_matrix, draw_tile

FIELDS, DEPTHS = 9, 25
# Blur of the tiles in units of half their width, as the side of a box of the same variance; the
# first one is what texels of the sharp tiles do. Must agree with lib/bokeh/bokeh_look_lib.glsl.
BLURS = (1.0 / 48.0, 1.0 / 20.0, 1.0 / 9.0, 1.0 / 4.0, 1.0 / 2.0)
SHARP, SOFT = 128, 64
AZIMUTHS = 48
# Texels of a sharp tile that are taken together, and places along the stop, for what an opening
# leaves.
_STEP, _PLACES = 2, 128
_VERGENCES = 7
_LEAST_LIGHT = 1e-3
# Terms that the scale of the picture changes by over the field; fields that tell distortion.
_SCALE_TERMS, _LEAST_FIELDS = 3, 4


@dataclass(frozen=True, eq=False)
class PupilTiles:
    """The textures of a lens' tiles.

    Parameters
    ----------
    sharp : ndarray of float32, shape (FIELDS * DEPTHS, SHARP, SHARP, 4)
        Density of light in a square from -e to e, e = 1 + the blur; integral 1 over the tile's
        own units. Then density times the place in the stop, x and y.
    soft : ndarray of float32, shape ((len(BLURS) - 1) * FIELDS * DEPTHS, SOFT, SOFT, 4)
        The same with more blur, blur by blur.
    places : ndarray of float32, shape (FIELDS, DEPTHS, 4)
        Outward shift of the pattern's middle and half its width across and along the azimuth,
        all over ``|c| + c0``.
    largest_tangent : float
        Of the last field.
    """

    sharp: np.ndarray
    soft: np.ndarray
    places: np.ndarray
    largest_tangent: float


def reach(blur):
    """Return the half width of a tile at a blur, in units of half its pattern's width."""
    return 1.0 + blur


class PupilBeams:
    """Beams of a lens at an f-number over field and vergence.

    Rays are lines behind the lens: the same beams serve all places of the sensor.

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
        for tangent in self.tangents:
            points = [_point(pupil, tangent, vergence) for vergence in self._nodes]
            ends = [points[k] for k in (0, _VERGENCES // 2, -1)]
            sides = np.array([_box(tables, point, f_number) for point in ends]).T
            # One grid for all: a ray of the grid is then a smooth function of the vergence.
            box = (sides[0].min(), sides[1].max(), sides[2].min(), sides[3].max())
            beams = [_traced(tables, point, f_number, box) for point in points]
            scale = beams[0].stop_scale
            self._image.append([np.concatenate([b.image, b.slope], axis=-1) for b in beams])
            self._rest.append(
                [
                    np.concatenate([b.stop / scale, b.weight[..., None], b.rims], axis=-1)
                    for b in beams
                ]
            )
        self._image = np.array(self._image)
        self._rest = np.array(self._rest, np.float32)

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
        rows = _refining(side)
        fine = np.tensordot(rows[RAYS // 2 :], coarse, axes=(1, 2))
        fine = np.tensordot(rows, fine, axes=(1, 2))
        # rows, columns, nodes, channels
        fine = np.ascontiguousarray(fine.transpose(2, 3, 0, 1))
        channels, shape = fine.shape[1], fine.shape[2:]
        mixed = mix.astype(np.float32) @ fine.reshape(count, -1)
        grids = []
        for part in mixed.reshape(-1, channels, *shape):
            x, y, stop_x, stop_y, weight, *rims = part
            grids.append(HalfGrid(x, y, stop_x, stop_y, tuple(rims), np.maximum(weight, 0.0)))
        return grids, centers - centers.mean()

    def width_in_focus(self, shift, vergence):
        """Return the largest half width of a focused point's patterns over the fields, mm."""
        widths = []
        for field in range(FIELDS):
            distorted = self.distorted(shift, vergence)
            grids, _ = self.grids(field, np.array([vergence]), shift, distorted)
            _, (_, *halves) = draw_tile(grids[0], SHARP, reach(BLURS[0]))
            widths += halves
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


def pupil_tiles(beams, shift, blur, soft, w_range):
    """Draw the tiles of a lens at one focus distance.

    Parameters
    ----------
    beams : PupilBeams
    shift : float
        Sensor's distance behind the sensor plane of the beams' tables, mm.
    blur : tuple of 2 float
        k0 in mm, k1 in mm^2: ``c = k0 + k1 V``.
    soft : float
        c0, mm.
    w_range : tuple of 2 float
        Rising.

    Returns
    -------
    PupilTiles
    """
    places = np.zeros((FIELDS, DEPTHS, 4), np.float32)
    soft_tiles = np.zeros((len(BLURS) - 1, FIELDS, DEPTHS, SOFT, SOFT, 4), np.float32)
    sharp_tiles = np.zeros((FIELDS, DEPTHS, SHARP, SHARP, 4), np.float32)
    depths = np.linspace(*w_range, DEPTHS)
    signed = soft * depths / (1.0 - np.abs(depths))
    vergences = np.maximum((signed - blur[0]) / blur[1], 0.0)
    sizes = np.abs(signed) + soft
    spans = [reach(width) for width in BLURS]
    distorted = beams.distorted(shift, -blur[0] / blur[1])
    matrices = [
        blur_matrix(width, SHARP, spans[0], SOFT, span)
        for width, span in zip(BLURS[1:], spans[1:], strict=True)
    ]
    for i in range(FIELDS):
        grids, centers = beams.grids(i, vergences, shift, distorted)
        for j, grid in enumerate(grids):
            tile, (middle, half_x, half_y) = draw_tile(grid, SHARP, spans[0])
            places[i, j, :3] = np.array([middle - centers[j], half_x, half_y]) / sizes[j]
            _store(sharp_tiles[i, j], tile, 0)
            for layer, matrix in enumerate(matrices, 1):
                _store(soft_tiles[layer - 1, i, j], matrix @ tile @ matrix.T, layer)
    return PupilTiles(
        sharp_tiles.reshape(-1, SHARP, SHARP, 4),
        soft_tiles.reshape(-1, SOFT, SOFT, 4),
        places,
        float(beams.tangents[-1]),
    )


def _at_zero(stop, height):
    """Height where the ray through the middle of the stop lands."""
    near = np.argsort(np.abs(stop))[:9]
    # A vignetted pupil may end before the middle of the stop.
    return float(np.polyval(np.polyfit(stop[near], height[near], 2), 0.0))


def _store(place, tile, layer):
    """Store a tile, (3, size, size), with its light 1 over its own units."""
    texel = 2.0 * reach(BLURS[layer]) / len(place)
    light = float(tile[0].sum(dtype=np.float64)) * texel**2
    np.multiply(np.moveaxis(tile, 0, -1), np.float32(1.0 / max(light, 1e-30)), out=place[..., :3])


def light_left(tiles, opening):
    """Share of the tiles' light that passes an opening at each azimuth.

    A splat reads a layer of the opening for blurs between those of the layers before and after;
    the tiles are blurred as the disc is.

    Parameters
    ----------
    tiles : PupilTiles
    opening : ndarray of shape (layers, size, size, 4)
        From `lens_bokeh.look.opening.opening_layers`.

    Returns
    -------
    ndarray of float32, shape (layers * 3 * FIELDS, AZIMUTHS + 1, DEPTHS, 4)
        Layer by layer for three blurs: that of the layer before, its own and that of the layer
        after. Red, green, blue: means of the opening's density over the light.
    """
    count = len(opening)
    through = _light_in_stop(tiles)
    channels = 3 if np.ptp(opening[..., :3], axis=-1).any() else 1
    result = np.empty((count, 3, FIELDS, AZIMUTHS + 1, DEPTHS, 4), np.float32)
    for layer, light in enumerate(opening):
        turned = _turned(light[..., :channels], extent(layer)).reshape(-1, _PLACES**2)
        passed = (through @ turned.T).reshape(len(BLURS), FIELDS, DEPTHS, -1)
        for step in range(3):
            mixed = np.tensordot(_tile_shares(LEAST_BLUR * 2.0 ** (layer + step - 1)), passed, 1)
            mixed = mixed.reshape(FIELDS, DEPTHS, AZIMUTHS, channels)
            result[layer, step, :, :AZIMUTHS, :, :3] = np.moveaxis(mixed, 2, 1)
    result[..., AZIMUTHS, :, :] = result[..., 0, :, :]
    result[..., 3] = 0.0
    return np.maximum(result, _LEAST_LIGHT).reshape(-1, AZIMUTHS + 1, DEPTHS, 4)


def _light_in_stop(tiles):
    """Light of the tiles over places in the stop, shape (blurs * FIELDS * DEPTHS, places)."""
    sharp = tiles.sharp.reshape(-1, SHARP // _STEP, _STEP, SHARP // _STEP, _STEP, 4)
    every = [sharp.sum(axis=(2, 4)), *tiles.soft.reshape(len(BLURS) - 1, -1, SOFT, SOFT, 4)]
    result = np.zeros((len(BLURS), FIELDS * DEPTHS, _PLACES**2), np.float32)
    for blurred, rows in zip(every, result, strict=True):
        for tile, row in zip(blurred.reshape(FIELDS * DEPTHS, -1, 4), rows, strict=True):
            lit = tile[:, 0] > 1e-6 * tile[:, 0].max()
            light = tile[lit, 0]
            stop = tile[lit, 1:3] / light[:, None] * STOP_SCALE - STOP_OFFSET
            stop /= np.maximum(np.hypot(stop[:, 0], stop[:, 1]), 1.0)[:, None]
            at = (stop + 1.0) * (0.5 * (_PLACES - 1))
            low = np.minimum(at.astype(np.int64), _PLACES - 2)
            part = at - low
            first = low[:, 1] * _PLACES + low[:, 0]
            for j, across in enumerate((1.0 - part[:, 1], part[:, 1])):
                for i, along in enumerate((1.0 - part[:, 0], part[:, 0])):
                    place = first + (j * _PLACES + i)
                    row += np.bincount(place, light * across * along, minlength=_PLACES**2)
            row /= max(float(light.sum(dtype=np.float64)), 1e-30)
    return result.reshape(-1, _PLACES**2)


def _turned(light, reach):
    """Turn an opening's layer: shape (AZIMUTHS, channels, places), float32."""
    size = len(light)
    axis = np.linspace(-1.0, 1.0, _PLACES)
    x, y = (part.ravel() for part in np.meshgrid(axis, axis))
    turn = 2.0 * np.pi * np.arange(AZIMUTHS)[:, None] / AZIMUTHS - 0.5 * np.pi
    cos, sin = np.cos(turn), np.sin(turn)
    places = np.stack([x * cos - y * sin, x * sin + y * cos])
    # Corners of the grid are outside of the stop: no light comes through there.
    at = np.clip((places / reach + 1.0) * (0.5 * size) - 0.5, 0.0, size - 1.001)
    low = at.astype(np.int64)
    (along, across), (column, row) = (at - low)[..., None], low
    result = np.zeros((AZIMUTHS, _PLACES**2, light.shape[-1]))
    for j, up in enumerate((1.0 - across, across)):
        for i, right in enumerate((1.0 - along, along)):
            result += light[row + j, column + i] * (up * right)
    return np.moveaxis(result, 1, 2).astype(np.float32)


def _tile_shares(blur):
    """Shares of the tiles' blurs in what a shader mixes for a blur."""
    squares = np.square(BLURS)
    wanted = np.clip(blur**2, squares[0], squares[-1])
    low = min(int(np.searchsorted(squares, wanted, side="right")) - 1, len(BLURS) - 2)
    shares = np.zeros(len(BLURS), np.float32)
    shares[low + 1] = (wanted - squares[low]) / (squares[low + 1] - squares[low])
    shares[low] = 1.0 - shares[low + 1]
    return shares
