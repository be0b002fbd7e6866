"""Patterns of a real lens over field and depth, as splats read them.

Each tile is the traced pattern of a point (`bokeh.pupil_beam`) at a field and a depth, in the
meridional frame: the picture's azimuth of the point is +y. It holds the light, and for each of its
texels the place in the stop that the light has come through, so that an iris of any shape can be
laid over it at any azimuth. A tile spans its pattern, wherever that lies: tiles of neighbouring
fields and depths can be mixed texel by texel while places and sizes are mixed as numbers.

Fields are even in the tangent of the angle, depths even in w (`bokeh.mapping`). Tiles carry unit
light: what vignetting takes from the energy is left out, as it is for the rest of the picture.
Beams are traced for a few vergences and interpolated.
"""

from dataclasses import dataclass

import numpy as np

from .deposit import deposit, open_weights, rays_for
from .opening import LEAST_BLUR, extent
from .pupil_beam import PupilBeam, beam_from_infinity, beam_from_point
from .ray_map import lagrange_weights

FIELDS, DEPTHS = 9, 25
# Blur of the tiles in units of half their width, as the side of a box of the same variance; the
# first one is what texels of the sharp tiles do. Must agree with lib/bokeh_look_lib.glsl.
BLURS = (1.0 / 48.0, 1.0 / 20.0, 1.0 / 7.0, 1.0 / 2.0)
SHARP, SOFT = 128, 64
# Rays along a side of a tile's grid, at most: neighbours then land a texel apart for most light.
_MOST_RAYS = 224
# Places in the stop are stored as (s + 1.5) / 3, to be positive.
STOP_OFFSET, STOP_SCALE = 1.5, 3.0
AZIMUTHS = 48
# Texels of a tile that are taken together.
_STEP = 2
_VERGENCES = 7
_LEAST_LIGHT = 1e-3


@dataclass(frozen=True, eq=False)
class PupilTiles:
    """What a shader samples.

    Parameters
    ----------
    sharp : ndarray of float32, shape (FIELDS * DEPTHS, SHARP, SHARP, 4)
        Density of light in a square from -e to e, e = 1 + the blur; integral 1 over the tile's
        own units. Then density times the place in the stop, x and y.
    soft : ndarray of float32, shape (3 * FIELDS * DEPTHS, SOFT, SOFT, 4)
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
    """Return how far a tile of a blur reaches, in units of half its pattern's width."""
    return 1.0 + blur


class PupilBeams:
    """Beams of a lens at an f-number over field and vergence.

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
        self._beams = []
        for tangent in self.tangents:
            ends = self._nodes[[0, _VERGENCES // 2, -1]]
            boxes = [_box(_traced(tables, pupil, f_number, tangent, v)) for v in ends]
            # One grid for all: a ray of the grid is then a smooth function of the vergence.
            sides = np.array(boxes).T
            box = (sides[0].min(), sides[1].max(), sides[2].min(), sides[3].max())
            self._beams.append(
                [_traced(tables, pupil, f_number, tangent, v, box) for v in self._nodes]
            )

    def at(self, field, vergence):
        """Return the beam of a field's number and a vergence."""
        weights, _ = lagrange_weights(self._nodes, vergence, len(self._nodes))
        beams = self._beams[field]
        mixed = {
            name: sum(w * getattr(b, name) for w, b in zip(weights, beams, strict=True))
            for name in ("image", "slope", "stop", "rims", "weight", "transmission", "pupil")
        }
        first = beams[0]
        return PupilBeam(
            **mixed,
            chief=first.chief,
            angle=first.angle,
            distance=first.distance,
            stop_scale=first.stop_scale,
        )


def _traced(tables, pupil, f_number, tangent, vergence, box=None):
    if vergence * 1e7 < 1.0:
        return beam_from_infinity(tables, float(np.arctan(tangent)), f_number, box=box)
    distance = 1.0 / vergence
    return beam_from_point(tables, tangent * distance, distance - pupil, f_number, box=box)


def _box(beam):
    (x0, v0), (x1, v1) = beam.pupil[0, 0], beam.pupil[-1, -1]
    return float(x0), float(x1), float(v0), float(v1)


def pupil_tiles(beams, shift, blur, soft, w_range):
    """Lay out the patterns at one focus.

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
    for j, w in enumerate(np.linspace(*w_range, DEPTHS)):
        c = soft * w / (1.0 - abs(w))
        vergence = max((c - blur[0]) / blur[1], 0.0)
        for i in range(FIELDS):
            tile, place = _tile(beams.at(i, vergence), shift)
            places[i, j, :3] = np.array(place) / (abs(c) + soft)
            sharp_tiles[i, j, ..., :3] = tile * _to_unit(tile, 0)
            for layer, width in enumerate(BLURS[1:], 1):
                matrix = _blur_matrix(width)
                blurred = np.moveaxis(matrix @ np.moveaxis(tile, -1, 0) @ matrix.T, 0, -1)
                soft_tiles[layer - 1, i, j, ..., :3] = blurred * _to_unit(blurred, layer)
    return PupilTiles(
        sharp_tiles.reshape(-1, SHARP, SHARP, 4),
        soft_tiles.reshape(-1, SOFT, SOFT, 4),
        places,
        float(beams.tangents[-1]),
    )


def _tile(beam, shift):
    """Light and stop places of a beam, and where the pattern stands, mm."""
    landing = beam.landing(shift)
    _, half_x, half_y = _bounds(beam, landing)
    count = rays_for(beam, shift, 2.0 * max(half_x, half_y) / SHARP)
    fine = beam.refined(min(count, _MOST_RAYS))
    # On the fine grid: rims of neighbouring tiles then lie at the same place.
    middle, half_x, half_y = _bounds(fine, fine.landing(shift))
    light = open_weights(fine)
    # The camera sees the stop turned by half a turn against the sensor's picture.
    stop = -fine.stop / fine.stop_scale
    at = (fine.landing(shift) - (0.0, middle)) / (half_x, half_y) / reach(BLURS[0])
    at = (at + 1.0) * (0.5 * SHARP)
    share = np.clip((stop + STOP_OFFSET) / STOP_SCALE, 0.0, 1.0)
    layers = [light, light * share[..., 0], light * share[..., 1]]
    tile = np.stack([deposit(at, layer, SHARP) for layer in layers], axis=-1)
    return tile, (middle - _center(beam, landing), half_x, half_y)


def _bounds(beam, landing):
    """Middle of a pattern along y and half its width in x and y, up to where rims cut it."""
    stop = np.hypot(beam.stop[..., 0], beam.stop[..., 1]) / beam.stop_scale
    clear = np.minimum(beam.clearance, 1.0 - stop)
    inside = clear > 0.0
    if not inside.any():
        inside = clear == clear.max()
    found = [landing[inside]]
    for axis in (0, 1):
        rays, signed = np.moveaxis(landing, axis, 0), np.moveaxis(clear, axis, 0)
        cut = (signed[1:] > 0.0) != (signed[:-1] > 0.0)
        low, high = signed[:-1][cut], signed[1:][cut]
        share = (low / (low - high))[:, None]
        found.append(rays[:-1][cut] * (1.0 - share) + rays[1:][cut] * share)
    x, y = np.concatenate(found).T
    half_x, half_y = np.abs(x).max(), 0.5 * (y.max() - y.min())
    return 0.5 * (y.min() + y.max()), max(half_x, 1e-6), max(half_y, 1e-6)


def _center(beam, landing):
    """Height where the ray through the middle of the stop lands: the point's pinhole picture."""
    column = beam.stop.shape[1] // 2
    stop, height = beam.stop[:, column, 1], landing[:, column, 1]
    near = np.argsort(np.abs(stop))[:9]
    # A vignetted pupil may end before the middle of the stop.
    return float(np.polyval(np.polyfit(stop[near], height[near], 2), 0.0))


def _to_unit(tile, layer):
    """Factor that makes the light of a tile 1 over its own units."""
    texel = 2.0 * reach(BLURS[layer]) / len(tile)
    return 1.0 / max(tile[..., 0].sum() * texel**2, 1e-30)


def _blur_matrix(width):
    """Matrix that blurs the texels of a sharp tile and samples them at those of a soft one."""
    source = (np.arange(SHARP) + 0.5) * (2.0 * reach(BLURS[0]) / SHARP) - reach(BLURS[0])
    at = (np.arange(SOFT) + 0.5) * (2.0 * reach(width) / SOFT) - reach(width)
    return np.exp(-0.5 * ((at[:, None] - source) * np.sqrt(12.0) / width) ** 2)


def light_left(tiles, opening):
    """Share of the tiles' light that an opening leaves at each azimuth.

    Parameters
    ----------
    tiles : PupilTiles
    opening : ndarray of shape (layers, size, size, 4)
        From `bokeh.opening.opening_layers`.

    Returns
    -------
    ndarray of float32, shape (layers * FIELDS, AZIMUTHS + 1, DEPTHS, 4)
        Red, green, blue: means of the opening's density over the light.
    """
    count, size = opening.shape[:2]
    result = np.empty((count, FIELDS, AZIMUTHS + 1, DEPTHS, 4), np.float32)
    turn = 2.0 * np.pi * np.arange(AZIMUTHS) / AZIMUTHS - 0.5 * np.pi
    turns = np.stack([np.cos(turn), np.sin(turn)])[..., None]
    blurs = [_as_blurred(tiles, LEAST_BLUR * 2.0**layer) for layer in range(count)]
    for layer, (light, blurred) in enumerate(zip(opening, blurs, strict=True)):
        for i in range(FIELDS):
            for j in range(DEPTHS):
                tile = blurred[i, j][blurred[i, j, :, 0] > 1e-6 * blurred[i, j, :, 0].max()]
                stop = tile[:, 1:3] / tile[:, :1] * STOP_SCALE - STOP_OFFSET
                stop /= np.maximum(np.hypot(stop[:, 0], stop[:, 1]), 1.0)[:, None]
                x = stop[:, 0] * turns[0] - stop[:, 1] * turns[1]
                y = stop[:, 0] * turns[1] + stop[:, 1] * turns[0]
                weight = tile[:, 0] / tile[:, 0].sum()
                at = ((np.stack([y, x]) / extent(layer) + 1.0) * (0.5 * size)).astype(int)
                passed = light[np.clip(at[0], 0, size - 1), np.clip(at[1], 0, size - 1), :3]
                result[layer, i, :AZIMUTHS, j, :3] = np.einsum("n,anc->ac", weight, passed)
    result[:, :, AZIMUTHS] = result[:, :, 0]
    result[..., 3] = 0.0
    return np.maximum(result, _LEAST_LIGHT).reshape(-1, AZIMUTHS + 1, DEPTHS, 4)


def _as_blurred(tiles, blur):
    """Texels of the tiles that a shader reads for a blur, shape (FIELDS, DEPTHS, texels, 4)."""
    nearest = int(np.argmin(np.abs(np.log2(np.array(BLURS) / blur))))
    if nearest > 0:
        soft = tiles.soft.reshape(-1, FIELDS, DEPTHS, SOFT * SOFT, 4)
        return soft[nearest - 1]
    sharp = tiles.sharp.reshape(FIELDS, DEPTHS, SHARP // _STEP, _STEP, SHARP // _STEP, _STEP, 4)
    return sharp.sum(axis=(3, 5)).reshape(FIELDS, DEPTHS, -1, 4)
