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

import numpy as np

from .opening import LEAST_BLUR, extent
from .pupil_beams import FIELDS
from .tile_drawing import STOP_OFFSET, STOP_SCALE, blur_matrix, blurred, draw_tile

DEPTHS = 25
# Blur of the tiles in units of half their width, as the side of a box of the same variance; the
# first one is what texels of the sharp tiles do. Must agree with lib/bokeh/bokeh_look_lib.glsl.
BLURS = (1.0 / 48.0, 1.0 / 20.0, 1.0 / 9.0, 1.0 / 4.0, 1.0 / 2.0)
SHARP, SOFT = 128, 64
AZIMUTHS = 48
# Texels of a sharp tile that are taken together, and places along the stop, for what an opening
# leaves.
_STEP, _PLACES = 2, 128
_LEAST_LIGHT = 1e-3


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


def tiles_in_steps(beams, shift, blur, soft, w_range):
    """Draw the tiles of a lens at one focus distance, field by field.

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

    Yields
    ------
    None
        After each field.

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
            store(sharp_tiles[i, j], tile, 0)
            for layer, soft_tile in enumerate(blurred(tile, matrices), 1):
                store(soft_tiles[layer - 1, i, j], soft_tile, layer)
        yield
    return PupilTiles(
        sharp_tiles.reshape(-1, SHARP, SHARP, 4),
        soft_tiles.reshape(-1, SOFT, SOFT, 4),
        places,
        float(beams.tangents[-1]),
    )


def pupil_tiles(*given):
    """Draw the tiles of a lens at one focus distance at once; as `tiles_in_steps`."""
    return result_of(tiles_in_steps(*given))


def result_of(steps):
    """Take all steps of a generator and return its result."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def store(place, tile, layer):
    """Store a tile, (3, size, size), in a texture's place with its light 1 over its own units."""
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
    for lit_tiles, rows in zip(every, result, strict=True):
        for tile, row in zip(lit_tiles.reshape(FIELDS * DEPTHS, -1, 4), rows, strict=True):
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
