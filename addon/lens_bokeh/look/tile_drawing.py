"""Fast drawing of the tiles of a real lens: patterns of many beams on grids of rays.

As `lens_bokeh.look.deposit`, but the grid has only the half of the pupil where x is positive, of
which the other is the mirror image, and 32-bit numbers; besides the light, the picture holds the
light times the place in the stop that it has come through.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

# Rays along a side of a tile's whole grid: neighbours then land a texel apart for most light.
RAYS = 224
# Rays farther apart are laid into pictures of half the resolution, a quarter, and so on.
_LEVELS = 6
# Clearance beyond which a rim cuts no ray: cells of the grid are far smaller.
_CLEAR = 0.1
# Least half width of a pattern.
_NARROWEST = 1e-6
# Places in the stop are stored as (s + 1.5) / 3, to be positive.
STOP_OFFSET, STOP_SCALE = 1.5, 3.0


@dataclass(frozen=True, eq=False)
class HalfGrid:
    """Rays of a beam through half the pupil; arrays of shape (rows, columns), columns along x > 0.

    Parameters
    ----------
    x, y : ndarray
        Landing places, mm; x from the meridional plane.
    stop_x, stop_y : ndarray
        Places in the stop, in units of its radius.
    rims : sequence of ndarray
        Signed clearances; positive inside.
    weight : ndarray
        Energy of the rays.
    """

    x: np.ndarray
    y: np.ndarray
    stop_x: np.ndarray
    stop_y: np.ndarray
    rims: tuple
    weight: np.ndarray

    def bounds(self):
        """Return the bounds of the pattern inside all rims.

        Returns
        -------
        tuple of 3 float
            Its middle along y, and half its width in x and in y.
        """
        x, y = self._outermost()
        bottom, top = float(y.min()), float(y.max())
        half_x = max(float(np.abs(x).max()), _NARROWEST)
        return 0.5 * (bottom + top), half_x, max(0.5 * (top - bottom), _NARROWEST)

    def _outermost(self):
        """Return where rays inside all rims land, and those at the rims."""
        clear = 1.0 - np.hypot(self.stop_x, self.stop_y)
        for rim in self.rims:
            clear = np.minimum(clear, rim)
        inside = clear > 0.0
        if not inside.any():
            inside = clear == clear.max()
        found = [(self.x[inside], self.y[inside])]
        for near, far in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
            cut = inside[near] != inside[far]
            low, high = clear[near][cut], clear[far][cut]
            share = low / (low - high)
            found.append(
                tuple(
                    place[near][cut] * (1.0 - share) + place[far][cut] * share
                    for place in (self.x, self.y)
                )
            )
        return tuple(np.concatenate(parts) for parts in zip(*found, strict=True))

    def light(self):
        """Return the energy of the rays behind all rims and the round stop, antialiased."""
        radius = np.hypot(self.stop_x, self.stop_y)
        width = np.maximum(_spacing(self.stop_x), _spacing(self.stop_y))
        opened = _share(1.0 - radius, width)
        lit = opened > 0.0
        for rim in self.rims:
            if lit.any() and rim[lit].min() < _CLEAR:
                opened = np.minimum(opened, _share(rim, _spacing(rim)))
        return self.weight * opened


class WholeGrid(HalfGrid):
    """Rays of a beam through all of the pupil, which need not be its own mirror image."""

    def bounds(self):
        """Return the bounds of the pattern inside all rims.

        Returns
        -------
        tuple of 4 float
            Its middle, and half its width, both in x and in y.
        """
        ends = [(float(part.min()), float(part.max())) for part in self._outermost()]
        middles = (0.5 * (low + high) for low, high in ends)
        return *middles, *(max(0.5 * (high - low), _NARROWEST) for low, high in ends)


def draw_tile(grid, size, span):
    """Draw the pattern of a beam.

    Parameters
    ----------
    grid : HalfGrid
    size : int
        Texels along a side.
    span : float
        Half the width of the tile, in units of half the pattern's.

    Returns
    -------
    tile : ndarray of float32, shape (3, size, size)
        Light; light times `stored` place in the stop as the camera sees it, x and y.
    bounds : tuple of 3 float
        As `HalfGrid.bounds`.
    """
    middle, half_x, half_y = bounds = grid.bounds()
    tile = _drawn(grid, (0.0, middle, half_x, half_y), size, span)
    # The other half: its places in the stop are mirrored, too.
    mirrored = tile[:, :, ::-1].copy()
    mirrored[1] = mirrored[0] - mirrored[1]
    return tile + mirrored, bounds


def draw_whole_tile(grid, size, span):
    """Draw the pattern of a beam; as `draw_tile`, of a `WholeGrid`."""
    bounds = grid.bounds()
    return _drawn(grid, bounds, size, span), bounds


def _drawn(grid, bounds, size, span):
    middle_x, middle, half_x, half_y = bounds
    light = grid.light()
    x = ((grid.x - middle_x) * (1.0 / (half_x * span)) + 1.0) * (0.5 * size)
    y = ((grid.y - middle) * (1.0 / (half_y * span)) + 1.0) * (0.5 * size)
    lit = light > 0.0
    # The camera sees the stop turned by half a turn against the sensor's picture.
    stored = [light] + [
        light * np.clip((STOP_OFFSET - place) / STOP_SCALE, 0.0, 1.0)
        for place in (grid.stop_x, grid.stop_y)
    ]
    wide_x, wide_y = _spacing(x)[lit], _spacing(y)[lit]
    return _deposited(x[lit], y[lit], wide_x, wide_y, [layer[lit] for layer in stored], size)


# Memo of its arguments alone, which are constants: one for each layer.
@cache
def blur_matrix(width, size, span, to_size, to_span):
    """Return the matrix that blurs the texels of a tile along an axis and samples them at others.

    Parameters
    ----------
    width : float
        Side of the box whose variance the blur has, in units of half the pattern's width.
    size, to_size : int
        Texels of the tile, and of the blurred one.
    span, to_span : float
        Half their widths.

    Returns
    -------
    ndarray of float32, shape (to_size, size)
    """
    source = (np.arange(size) + 0.5) * (2.0 * span / size) - span
    at = (np.arange(to_size) + 0.5) * (2.0 * to_span / to_size) - to_span
    blur = np.exp(-0.5 * ((at[:, None] - source) * np.sqrt(12.0) / width) ** 2)
    return blur.astype(np.float32)


def blurred(tile, matrices):
    """Blur a tile that is its own mirror image, as `draw_tile` returns it.

    Half of it is blurred, as is half of what its places in the stop are off the mirror line; that
    is a third of the work of ``matrix @ tile @ matrix.T``.

    Parameters
    ----------
    tile : ndarray of float32, shape (3, size, size)
    matrices : sequence of ndarray
        Of `blur_matrix`.

    Yields
    ------
    ndarray of float32, shape (3, to_size, to_size)
        With each of the matrices.
    """
    middle = tile.shape[-1] // 2
    half = tile[..., :middle].copy()
    half[1] -= 0.5 * half[0]
    for matrix in matrices:
        across = len(matrix) // 2
        left, right = matrix[:across, :middle], matrix[:across, : -middle - 1 : -1]
        even, odd = (left + right).T, (left - right).T
        part = np.stack([half[0] @ even, half[1] @ odd, half[2] @ even])
        part = matrix @ part
        whole = np.empty((3, len(matrix), 2 * across), np.float32)
        whole[..., :across] = part
        whole[..., across:] = part[..., ::-1]
        whole[1, :, across:] *= -1.0
        whole[1] += 0.5 * whole[0]
        yield whole


def _deposited(x, y, wide_x, wide_y, layers, size):
    """Spread energies over texels, each over a square as wide as its neighbours are apart."""
    wide = np.maximum(wide_x, wide_y)
    picture = np.zeros((len(layers), size, size), np.float32)
    bound = 1.0
    for level in range(_LEVELS):
        last = level == _LEVELS - 1
        here = (wide <= bound) if not last else np.ones(len(wide), bool)
        if level:
            here &= wide > 0.5 * bound
        if here.any():
            scale = 1.0 / bound
            count = -(-size // 2**level)
            laid = _laid(
                *(part[here] * np.float32(scale) for part in (x, y, wide_x, wide_y)),
                [layer[here] for layer in layers],
                count,
            )
            if level:
                laid = laid.repeat(2**level, axis=1).repeat(2**level, axis=2) / 4.0**level
            picture += laid[:, :size, :size]
        bound *= 2.0
    return picture


def _laid(x, y, wide_x, wide_y, layers, size):
    columns, left = _shares(x, wide_x)
    rows, low = _shares(y, wide_y)
    # A margin of two texels takes the light that falls outside, and that of its next texel.
    stride = size + 4
    columns, rows = (np.clip(first, -2, size) + 2 for first in (columns, rows))
    corner = rows * stride + columns
    shares = ((0, low * left), (1, low * (1.0 - left)))
    shares += ((stride, (1.0 - low) * left), (stride + 1, (1.0 - low) * (1.0 - left)))
    picture = np.zeros((len(layers), stride * stride))
    for step, share in shares:
        texel = corner + step
        for total, layer in zip(picture, layers, strict=True):
            total += np.bincount(texel, layer * share, minlength=stride * stride)
    return picture.reshape(-1, stride, stride)[:, 2:-2, 2:-2]


def _shares(place, width):
    """First texel that an interval touches, and its share; the next texel has the rest."""
    width = np.clip(width, 1e-6, 1.0)
    start = place - 0.5 * width
    first = np.floor(start)
    share = np.clip((first + 1.0 - start) / width, 0.0, 1.0)
    return np.clip(first, -1e6, 1e6).astype(np.int64), share


def _share(clearance, width):
    """Share of each cell inside the zero of a signed function."""
    return np.clip(0.5 + clearance / np.maximum(width, 1e-12), 0.0, 1.0)


def _spacing(values):
    """Change of a quantity from ray to ray, along both axes together."""
    change = np.empty_like(values)
    np.subtract(values[2:], values[:-2], out=change[1:-1])
    change[1:-1] *= 0.5
    change[0], change[-1] = values[1] - values[0], values[-1] - values[-2]
    np.abs(change, out=change)
    across = np.abs(values[:, 2:] - values[:, :-2])
    across *= 0.5
    change[:, 1:-1] += across
    change[:, 0] += np.abs(values[:, 1] - values[:, 0])
    change[:, -1] += np.abs(values[:, -1] - values[:, -2])
    return change
