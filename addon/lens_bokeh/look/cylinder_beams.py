"""Discs of a lens with cylinders: beams and tiles over two axes of the field.

Such a lens has no meridional frame: it is its own mirror image to both sides of the x and of the y
axis, so that tiles are drawn for points of the upper right quarter of the picture, in its own
frame. The rays are those of lens samples, as sums of terms. Lengths are tangents.
"""

import numpy as np

from .splat_pupil import BLURS, SHARP, SOFT, PupilTiles, reach, store
from .tile_drawing import RAYS, WholeGrid, blur_matrix, draw_whole_tile

# Fields along x and y, and depths; as many tiles as of a lens of revolution. They must agree with
# lib/bokeh/bokeh_look_lib.glsl.
ACROSS, DEPTHS = 5, 9
# Rays farther out than this, in radii of the iris, count as there.
_OUTERMOST = 1.05
# Step of the field that changes of light are found with, as a share of its extent.
_STEP = 0.02


class CylinderBeams:
    """Beams of a lens with cylinders over field and vergence.

    Parameters
    ----------
    rays : CylinderRays
    aperture_radius : float
        m.
    grid : FieldGrid
        Of the picture.
    largest : tuple of 2 float
        Tangents of the farthest fields wanted along x and y.
    """

    def __init__(self, rays, aperture_radius, grid, largest):
        self._rays, self._radius = rays, aperture_radius
        self.tangents = tuple(
            np.linspace(0.0, min(wanted, traced[-1]), ACROSS)
            for wanted, traced in zip(largest, rays.fields, strict=True)
        )
        x, y = self.tangents
        nodes = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        axis = (np.arange(RAYS) + 0.5) / RAYS * 2.0 - 1.0
        places = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
        self._places = places.astype(np.float32)
        away = np.hypot(*places.T)[:, None]
        held = places * np.minimum(_OUTERMOST / np.maximum(away, 1e-9), 1.0)
        terms, middle = rays.terms(held), rays.terms(np.zeros((1, 2)))
        self._terms = terms.astype(np.float32)
        self._from_middle = (terms - middle).astype(np.float32)
        moves, self._chief = rays.moves(nodes)
        self._moves = np.moveaxis(moves * aperture_radius, 1, 0)
        self._moves[..., 0] *= rays.stretch
        step = _STEP * np.array([x[-1], y[-1]])
        around = [nodes, *(nodes + sign * part for part in np.diag(step) for sign in (1, -1))]
        found = rays.landed(aperture_radius, grid, np.concatenate(around))
        here, right, left, up, down = np.split(found, 5, axis=-1)
        self._light = here, (right - left) / (2.0 * step[0]), (up - down) / (2.0 * step[1])

    def grids(self, field, vergences):
        """Return the rays of a field's beams; y-major fields.

        Parameters
        ----------
        field : int
        vergences : sequence of float
            1/m.

        Returns
        -------
        list of WholeGrid
        """
        rays, shape = self._rays, (RAYS, RAYS)
        clear = [(each[..., field] @ self._terms.T).astype(np.float32) for each in self._light]
        grids = []
        for vergence in vergences:
            powers = np.minimum(vergence / rays.largest_vergence, 1.0) ** np.arange(4)
            moves = np.einsum("k,tkc->tc", powers, self._moves[field]).astype(np.float32)
            thin = np.float32(self._radius * (rays.focus_vergence - vergence))
            off = self._places * thin + self._from_middle @ moves
            # Light and rims are those of the place where a ray lands.
            x, y = (off + (powers @ self._chief[field]).astype(np.float32)).T
            values = clear[0] + clear[1] * (x / np.float32(rays.stretch)) + clear[2] * y
            light = np.clip(values[0], 0.0, rays.most_light)
            parts = (off[:, 0], off[:, 1], -self._places[:, 0], -self._places[:, 1])
            rims = tuple(each.reshape(shape) for each in values[1:])
            grids.append(
                WholeGrid(*(each.reshape(shape) for each in parts), rims, light.reshape(shape))
            )
        return grids

    @property
    def softness(self):
        """Largest of the patterns in focus: half its width, a tangent."""
        focus = [self._rays.focus_vergence]
        every = (self.grids(field, focus)[0].bounds()[2:] for field in range(ACROSS**2))
        return max(max(each) for each in every)


def cylinder_tiles(beams, blur, soft, w_range):
    """Draw the tiles of a lens with cylinders at one focus distance.

    Parameters
    ----------
    beams : CylinderBeams
    blur : tuple of 2 float
        k0, and k1 in m: ``c = k0 + k1 V``.
    soft : float
        c0, a tangent.
    w_range : tuple of 2 float
        Rising.

    Returns
    -------
    PupilTiles
        `places` has the shift of the pattern's middle and half its width, both along x and y;
        `largest_tangent` is along x and y.
    """
    fields = ACROSS**2
    places = np.zeros((fields, DEPTHS, 4), np.float32)
    soft_tiles = np.zeros((len(BLURS) - 1, fields, DEPTHS, SOFT, SOFT, 4), np.float32)
    sharp_tiles = np.zeros((fields, DEPTHS, SHARP, SHARP, 4), np.float32)
    depths = np.linspace(*w_range, DEPTHS)
    signed = soft * depths / (1.0 - np.abs(depths))
    vergences = np.maximum((signed - blur[0]) / blur[1], 0.0)
    sizes = np.abs(signed) + soft
    spans = [reach(width) for width in BLURS]
    matrices = [
        blur_matrix(width, SHARP, spans[0], SOFT, span)
        for width, span in zip(BLURS[1:], spans[1:], strict=True)
    ]
    for i in range(fields):
        for j, grid in enumerate(beams.grids(i, vergences)):
            tile, bounds = draw_whole_tile(grid, SHARP, spans[0])
            places[i, j] = np.array(bounds) / sizes[j]
            store(sharp_tiles[i, j], tile, 0)
            for layer, matrix in enumerate(matrices, 1):
                store(soft_tiles[layer - 1, i, j], matrix @ tile @ matrix.T, layer)
    return PupilTiles(
        sharp_tiles.reshape(-1, SHARP, SHARP, 4),
        soft_tiles.reshape(-1, SOFT, SOFT, 4),
        places,
        tuple(float(each[-1]) for each in beams.tangents),
    )
