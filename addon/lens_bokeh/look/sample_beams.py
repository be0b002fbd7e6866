"""Beams of a lens over field and vergence for tiles of its discs, from the rays of lens samples.

The rays are the sums of terms that displace lens samples: discs and samples are the same lens.
Lengths are tangents; the middle of the iris lands at 0.

A ray's energy in the picture is its light where it lands, times how much larger it shows a surface
than a pinhole does, over the mean light of all rays that land there: an even exposure divides
by that.
"""

import numpy as np

from ..samples.disc_terms import disc_terms
from ..samples.field_grid import FieldGrid
from ..samples.landing import landed
from .pupil_beams import field_tangents
from .tile_drawing import RAYS, HalfGrid, WholeGrid

# Fields along x and y of a lens with cylinders.
ACROSS = 5
# Rays farther out than this, in radii of the iris, count as there: sums of terms go astray.
_OUTERMOST = 1.05
# Step of the field that changes are found with, as a share of its extent.
_STEP = 0.02
# Nodes along the field that tell how far rays land aside.
_NODES = 49
# Least of the mean light near a disc, over that in its middle.
_LEAST_MEAN = 0.25


class SampleBeams:
    """Beams at some fields.

    Parameters
    ----------
    rays : LensRays, CylinderRays or ArtistRays
    aperture_radius : float
        m.
    fields : ndarray of shape (F, 2)
    grid : type
        `HalfGrid` for fields above the axis of a lens of revolution, or `WholeGrid`.
    """

    def __init__(self, rays, aperture_radius, fields, grid):
        self._rays, self._radius, self._grid = rays, aperture_radius, grid
        self._nodes, self._fields = fields, []
        self._step = _STEP * np.maximum(np.abs(fields).max(axis=0), 1e-9)
        if rays.of_revolution:
            self._step[:] = self._step.max()
        axis = (np.arange(RAYS) + 0.5) / RAYS * 2.0 - 1.0
        columns = axis if grid is WholeGrid else axis[RAYS // 2 :]
        places = np.stack(np.meshgrid(columns, axis), axis=-1)
        self._shape = places.shape[:2]
        places = places.reshape(-1, 2)
        away = np.hypot(*places.T)[:, None]
        held = places * np.minimum(_OUTERMOST / np.maximum(away, 1e-9), 1.0)
        terms, middle = (
            disc_terms(rays.orders, each).reshape(len(each), -1)
            for each in (held, np.zeros((1, 2)))
        )
        self._places = places.T.astype(np.float32)
        self._terms = terms.astype(np.float32)
        self._from_middle = (terms - middle).astype(np.float32)

    def followed(self):
        """Follow the rays of what is not yet followed, field by field.

        Yields
        ------
        None
            After each field.
        """
        x, y = np.diag(self._step)
        around = np.array([0.0 * x, x, -x, y, -y])
        nodes = self._nodes[:, None] + around
        light = landed(self._rays, self._radius, self._wide(), nodes.reshape(-1, 2))
        light = light.astype(np.float32).reshape(*light.shape[:2], *nodes.shape[:2])
        while len(self._fields) < len(self._nodes):
            field = len(self._fields)
            self._fields.append(self._follow(nodes[field], light[:, :, field]))
            yield

    def grids(self, field, vergences):
        """Return the rays of a field's beams.

        Parameters
        ----------
        field : int
        vergences : sequence of float
            1/m.

        Returns
        -------
        list of HalfGrid or WholeGrid
        """
        rays, grids = self._rays, []
        moves, slopes, chief, (here, right, up), mean = self._fields[field]
        reach = rays.largest_vergence - rays.focus_vergence
        for vergence in vergences:
            powers = np.minimum(vergence / rays.largest_vergence, 1.0) ** np.arange(4)
            powers *= max((vergence - rays.focus_vergence) / reach, 1.0)
            powers = powers.astype(np.float32)
            thin = np.float32(self._radius * (rays.focus_vergence - vergence))
            x, y = self._places * thin + np.tensordot(powers, moves, 1)
            (x_x, y_x), (x_y, y_y) = np.tensordot(powers, slopes, 1)
            larger = np.abs((1.0 + x_x) * (1.0 + y_y) - x_y * y_x)
            # Light and rims are those of the place where a ray lands.
            away_x, away_y = powers @ chief
            away_x, away_y = x / np.float32(rays.stretch) + away_x, y + away_y
            light, *rims = here + right * away_x + up * away_y
            light = np.clip(light, 0.0, rays.most_light) * larger
            even = mean[0] + mean[1] * away_x + mean[2] * away_y
            light /= np.maximum(even, _LEAST_MEAN * mean[0])
            # As of a traced lens, whose stop is seen from the sensor.
            parts = (x, y, *-self._places, light, *rims)
            x, y, stop_x, stop_y, light, *rims = (each.reshape(self._shape) for each in parts)
            grids.append(self._grid(x, y, stop_x, stop_y, tuple(rims), light))
        return grids

    @property
    def softness(self):
        """Largest of the patterns in focus: half its width, a tangent."""
        focus = [self._rays.focus_vergence]
        grids = (self.grids(field, focus)[0] for field in range(len(self._nodes)))
        return max(grid.half_width() for grid in grids)

    def _follow(self, nodes, light):
        """Return what `grids` needs of a field.

        Movements, (4, 2, N), and their slopes, (4, 2, 2, N): powers of the vergence first, axes of
        the field second. Movements of the middle, (4, 2). Light and rims, and their slopes along x
        and y: three of shape (1 + S, N). Their mean light, and its slopes.
        """
        rays, (step_x, step_y) = self._rays, self._step
        moves, chief = rays.moves(nodes)
        # The last three: terms, powers, x and y.
        moves = np.moveaxis(moves * self._radius, 1, 0).astype(np.float32)
        own = np.tensordot(self._from_middle, moves[0], 1)
        own[..., 0] *= rays.stretch
        slopes = []
        for ahead, behind, step in ((1, 2, step_x), (3, 4, step_y)):
            change = (moves[ahead] - moves[behind]) / np.float32(2.0 * step)
            middle = (chief[ahead] - chief[behind]) / (2.0 * step)
            slopes.append(np.tensordot(self._from_middle, change, 1) + middle)
        every = np.einsum("nt,stp->psn", self._terms, light, optimize=True)
        pairs = ((1, 2, step_x), (3, 4, step_y))
        changes = [(every[a] - every[b]) / np.float32(2.0 * step) for a, b, step in pairs]
        means = [self._mean(each) for each in every]
        return (
            np.ascontiguousarray(np.moveaxis(own, 0, -1)),
            np.ascontiguousarray(np.transpose(slopes, (2, 0, 3, 1)), np.float32),
            chief[0].astype(np.float32),
            (every[0], *changes),
            (max(means[0], 1e-9), *((means[a] - means[b]) / (2.0 * step) for a, b, step in pairs)),
        )

    def _wide(self):
        """Return a grid whose steps tell how far rays land aside."""
        reach = np.maximum(np.abs(self._nodes).max(axis=0), self._step)
        if self._rays.of_revolution:
            reach = np.full(2, reach.max())
        return FieldGrid(-reach, reach, _NODES, _NODES)

    def _mean(self, values):
        """Return the mean light of the iris, of light and rims at a place of the picture."""
        light, *rims = (each.reshape(self._shape) for each in values)
        stop = (part.reshape(self._shape) for part in self._places)
        light = np.clip(light, 0.0, self._rays.most_light)
        return float(self._grid(light, light, *stop, tuple(rims), light).light().mean())


def meridional_beams(rays, aperture_radius, largest_tangent):
    """Return the `SampleBeams` of a lens of revolution, and the fields, as tangents.

    Parameters
    ----------
    rays : LensRays or ArtistRays
    aperture_radius : float
        m.
    largest_tangent : float
        Of the field that is wanted.
    """
    tangents = field_tangents(min(largest_tangent, rays.farthest))
    fields = np.stack([np.zeros_like(tangents), tangents], axis=-1)
    return SampleBeams(rays, aperture_radius, fields, HalfGrid), tangents


def quarter_beams(rays, aperture_radius, largest):
    """Return the `SampleBeams` of a lens with cylinders, and the fields along x and y.

    Such a lens has no meridional frame: it is its own mirror image to both sides of the x and of
    the y axis, so that beams are those of points of the upper right quarter of the picture, row by
    row.

    Parameters
    ----------
    rays : CylinderRays
    aperture_radius : float
        m.
    largest : tuple of 2 float
        Tangents of the farthest fields wanted along x and y.
    """
    tangents = tuple(
        np.linspace(0.0, min(wanted, traced[-1]), ACROSS)
        for wanted, traced in zip(largest, rays.fields, strict=True)
    )
    fields = np.stack(np.meshgrid(*tangents), axis=-1).reshape(-1, 2)
    return SampleBeams(rays, aperture_radius, fields, WholeGrid), tangents
