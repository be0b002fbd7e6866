"""What a real lens does to lens samples, as small tables over the picture: for shaders and bounds.

Two grids over the picture's field (tangents), evenly spaced in x and y; texels lie on its nodes:

- *moves*: by how much a point of field H and vergence V is displaced by a sample beyond the thin
  lens' shear, in tangents, a cubic in V. Over H; outside of the grid what its edge has.
- *light*: which share of the light of a place of the picture a sample lets through, over the share
  of the axis or over the mean of all places of the iris. Between nodes it is linear, and so is the
  sum over samples.

The thin lens is the camera's: aperture radius a, focus 1 / Vf. A sample at v = a q moves a point by
``v (Vf - V)``; the real lens moves it by a share ``a / p`` of what it does to one at p q, so that a
camera whose focal length is not that of the lens keeps its blur (as discs do). An anamorphic ratio
makes the opening narrower, and movements with it.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .disc_terms import disc_terms
from .field_grid import FieldGrid
from .landing import landed, spread_places
from .seen_fields import SeenFields, fields_on_circles, seen_fields

_GRADIENT_PLACES, _NUDGE = 96, 1e-3
# Width of a rim's edge over the distance of samples: it takes noise away, but more would darken.
_SOFT = 0.5
# Places of the iris that a blur is fitted to.
_BLUR_PLACES = 64
# Clearance of rims that never cut, at the places that the slope is found for.
_CLEAR = 0.1


@dataclass(frozen=True, eq=False)
class SampleTables:
    """Tables of a lens over a picture, from which those of any lens sample are made.

    Parameters
    ----------
    moves_grid, light_grid : FieldGrid
    aperture_radius : float
        Of the camera's thin lens, m.
    ratio : float
        Anamorphic.
    focus_vergence, largest_vergence : float
        1/m. Nearer points go on as those at the largest vergence.
    """

    moves_grid: FieldGrid
    light_grid: FieldGrid
    aperture_radius: float
    ratio: float
    focus_vergence: float
    largest_vergence: float
    orders: np.ndarray
    _moves: np.ndarray
    _chief: np.ndarray
    _light: np.ndarray
    _rims: np.ndarray
    _slopes: np.ndarray
    _most_light: float
    _seen: SeenFields
    _colors: tuple = ()

    def places(self, lens_positions):
        """Places of the iris of lens positions, shape (N, 2).

        Parameters
        ----------
        lens_positions : ndarray of shape (N, 2)
            In m.
        """
        return lens_positions * np.array([self.ratio, 1.0]) / self.aperture_radius

    def moves(self, lens_positions, colors=None):
        """Tables of the displacement of lens samples.

        Parameters
        ----------
        lens_positions : ndarray of shape (N, 2)
            In m.
        colors : ndarray of shape (N, 2, K) or None
            Shares of the K traced wavelengths' differences in the aberrations and in the rays
            through the middle of the iris; None: the reference wavelength.

        Returns
        -------
        ndarray of float32, shape (N, rows, columns, 4, 2)
            Coefficients of the powers of V over the largest vergence, x and y.
        """
        grid = self.moves_grid
        found, reach = self._followed(lens_positions, colors)
        found = self._seen.held(found, reach)
        return found.reshape(-1, grid.rows, grid.columns, 4, 2).astype(np.float32)

    def _followed(self, lens_positions, colors):
        """Return movements at nodes and circles, and how far samples see."""
        terms = disc_terms(self.orders, np.append(self.places(lens_positions), [[0.0, 0.0]], 0))
        from_middle = (terms[:-1] - terms[-1]).reshape(len(lens_positions), -1)
        found = _mixed(from_middle, colors, (self._moves, *(moves for moves, _ in self._colors)))
        found = found.reshape(-1, *self._chief.shape) + self._chief
        if colors is not None:
            for share, (_, chief) in zip(colors[:, 1].T, self._colors, strict=True):
                found += share[:, None, None, None] * chief
        terms = terms[:-1].reshape(len(lens_positions), -1)
        return found, self._seen.reach(terms, found[:, -self._seen.count :])

    @cached_property
    def blur(self):
        """What the lens adds to the thin lens' signed radius of the circle of confusion.

        The radius is that of the disc that displacements over the whole iris are nearest to, in
        least squares: aberrations that make no disc larger or smaller do not count.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 4)
            As a tangent: coefficients of the powers of V over the largest vergence.
        """
        places = spread_places(_BLUR_PLACES) / (self.ratio, 1.0)
        moves = self.moves(places * self.aperture_radius)
        # The thin lens' own are -places times the radius.
        found = -np.einsum("nyxkc,nc->yxk", moves, places) / np.square(places).sum()
        return found.astype(np.float32)

    @cached_property
    def area(self):
        """How much larger the whole iris shows small surfaces than a pinhole does.

        Returns
        -------
        ndarray of float32, shape (rows, columns, 4)
            Mean over the iris: coefficients of the powers of V over the largest vergence.
        """
        grid = self.moves_grid
        moves = self.moves(spread_places(_BLUR_PLACES) / (self.ratio, 1.0) * self.aperture_radius)
        step = (grid.high - grid.low) / (grid.columns - 1, grid.rows - 1)
        at = 0.5 - 0.5 * np.cos((np.arange(4) + 0.5) / 4.0 * np.pi)
        powers = at[:, None] ** np.arange(4)
        seen = np.einsum("vk,nyxkc->vnyxc", powers, moves)
        up, right = (
            np.gradient(seen, size, axis=axis) for size, axis in ((step[1], 2), (step[0], 3))
        )
        larger = (1.0 + right[..., 0]) * (1.0 + up[..., 1]) - right[..., 1] * up[..., 0]
        found = np.einsum("kv,vyx->yxk", np.linalg.inv(powers), np.abs(larger).mean(axis=1))
        return found.astype(np.float32)

    def turns(self, lens_positions, colors=None):
        """Tables of how displacements change with the place on the lens.

        Parameters
        ----------
        lens_positions : ndarray of shape (N, 2)
            In m.
        colors : ndarray of shape (N, 2, K) or None
            As of `moves`.

        Returns
        -------
        ndarray of shape (N, rows, columns, 2, 2, 2)
            Derivatives of `moves`, 1/m: the powers 0 and 1 of V over the largest vergence; x and y
            of the displacement; by x and by y on the lens.
        """
        grid, places, found = self.moves_grid, self.places(lens_positions), []
        for axis, scale in enumerate((self.ratio, 1.0)):
            step = np.zeros(2)
            step[axis] = _NUDGE
            ahead, behind = (disc_terms(self.orders, places + s) for s in (step, -step))
            slopes = (ahead - behind).reshape(len(places), -1) * (0.5 * scale / _NUDGE)
            found.append(_mixed(slopes, colors, self._linear_moves) / self.aperture_radius)
        found = np.stack(found, axis=-1).reshape(len(places), -1, 2, 2, 2)
        found = self._seen.held(found, self._followed(lens_positions, colors)[1])
        return found.reshape(-1, grid.rows, grid.columns, 2, 2, 2)

    @cached_property
    def _linear_moves(self):
        """Tables of moves as straight lines over the vergence, through two Chebyshev points."""
        at = 0.5 - 0.5 * np.array([1.0, -1.0]) * np.sqrt(0.5)
        line = np.linalg.inv(at[:, None] ** np.arange(2)) @ at[:, None] ** np.arange(4)
        found = []
        for each in (self._moves, *(moves for moves, _ in self._colors)):
            moves = each.reshape(len(each), -1, 4, 2)
            found.append(np.einsum("lk,tnkc->tnlc", line, moves).reshape(len(moves), -1))
        return found

    def light(self, lens_positions, spacing=0.0):
        """Tables of the light of lens samples, without a division.

        Parameters
        ----------
        lens_positions : ndarray of shape (N, 2)
            In m.
        spacing : float
            Distance of neighbouring samples in radii of the iris: rims are half as soft.

        Returns
        -------
        ndarray of shape (N, rows, columns)
            Over that of a ray through the middle of picture and iris; at least 0.
        """
        grid = self.light_grid
        found = self._light_at(self.places(lens_positions), spacing, slice(0, -1))
        return found.reshape(-1, grid.rows, grid.columns)

    def axial_light(self, lens_positions, spacing=0.0):
        """Light of lens samples on the optical axis, shape (N,); as `light`."""
        return self._light_at(self.places(lens_positions), spacing, slice(-1, None))[:, 0]

    def displaced(self, eye, moves, lens_position):
        """Displace points as a shader does, for one sample: the numpy twin.

        Parameters
        ----------
        eye : ndarray of shape (P, 3)
            Points of camera space, m.
        moves : ndarray of shape (rows, columns, 4, 2)
            Of the sample.
        lens_position : ndarray of shape (2,)
            In m.

        Returns
        -------
        ndarray of shape (P, 3)
            Where a pinhole in the camera's place has them.
        """
        moved = eye.copy()
        moved[:, :2] -= lens_position * (1.0 + eye[:, 2] * self.focus_vergence)[:, None]
        moved[:, :2] += self.added(eye, moves.reshape(1, -1, 4, 2))[0]
        return moved

    def added(self, eye, moves):
        """Return what samples add to the thin lens' displacement of points.

        Parameters
        ----------
        eye : ndarray of shape (P, 3)
            Points of camera space, m.
        moves : ndarray of shape (N, rows * columns, 4, 2)

        Returns
        -------
        ndarray of shape (N, P, 2)
            In m.
        """
        depth = np.maximum(-eye[:, 2], 1e-9)
        vergence = 1.0 / depth
        index, weights = self.moves_grid.taps(eye[:, :2] * vergence[:, None])
        near = np.minimum(vergence / self.largest_vergence, 1.0)
        beyond = (vergence - self.focus_vergence) / (self.largest_vergence - self.focus_vergence)
        powers = near[:, None] ** np.arange(4) * (depth * np.maximum(beyond, 1.0))[:, None]
        return np.einsum("pt,pk,nptkc->npc", weights, powers, moves[:, index].astype(float))

    def _light_at(self, places, spacing, nodes):
        terms = disc_terms(self.orders, places).reshape(len(places), -1)
        light = np.clip(terms @ self._light[:, nodes], 0.0, self._most_light)
        for rim, slope in zip(self._rims[..., nodes], self._slopes[..., nodes], strict=True):
            clear = terms @ rim
            if spacing > 0.0:
                light *= np.clip(0.5 + clear / (_SOFT * spacing * slope), 0.0, 1.0)
            else:
                light *= clear >= 0.0
        return light


def _mixed(terms, colors, tables):
    """Sum up the terms of samples, with shares of other wavelengths' tables, if there are any."""
    found = terms @ tables[0]
    if colors is not None:
        for share, table in zip(colors[:, 0].T, tables[1:], strict=True):
            found += share[:, None] * (terms.astype(table.dtype) @ table)
    return found


def sample_tables(rays, grid, wide_grid, aperture_radius, ratio=1.0, outermost=np.inf):
    """Lay out a lens over a picture.

    Parameters
    ----------
    rays : LensRays
    grid : FieldGrid
        Of the picture, for the light.
    wide_grid : FieldGrid
        Wider, for points outside of the picture that are blurred into it.
    aperture_radius : float
        Of the camera's thin lens, m.
    ratio : float
        Anamorphic.
    outermost : float
        Distance of the camera's own picture's corner from the axis, a tangent: farther out, which
        only a viewport shows, the light is that of the corner.

    Returns
    -------
    SampleTables
    """
    largest = float(rays.largest_vergence)
    circles, tangents = fields_on_circles(rays)
    fields = np.concatenate([wide_grid.nodes, circles])
    moves, chief = _moves(rays, fields, aperture_radius, ratio)
    # The nodes of the picture, and the axis.
    wanted = np.append(grid.nodes, [[0.0, 0.0]], axis=0)
    away = np.hypot(*wanted.T)
    wanted *= np.minimum(outermost / np.maximum(away, 1e-30), 1.0)[:, None]
    every = landed(rays, aperture_radius, grid, wanted)
    # Rays are followed to the last light.
    every[0, :, :-1][:, np.minimum(away[:-1], outermost) > rays.last_seen] = 0.0
    light, rims = every[0], every[1:]
    slopes, least = _rim_slopes(rims, rays.orders)
    colors = []
    if rays.colors is not None:
        for changed, chiefs in zip(rays.colors.aberrations, rays.colors.chief, strict=True):
            other = replace(rays, aberrations=changed, chief=chiefs)
            over, middle = _moves(other, fields, aperture_radius, ratio)
            colors.append((over.reshape(len(over), -1).astype(np.float32), middle))
    # Rims that cut nothing of this picture.
    cutting = least < _CLEAR
    rims, slopes = rims[cutting], slopes[cutting]
    return SampleTables(
        moves_grid=wide_grid,
        light_grid=grid,
        aperture_radius=aperture_radius,
        ratio=ratio,
        focus_vergence=rays.focus_vergence,
        largest_vergence=largest,
        orders=rays.orders,
        _moves=np.ascontiguousarray(moves.reshape(len(moves), -1)),
        _chief=chief,
        _light=light,
        _rims=rims,
        _slopes=slopes,
        _most_light=rays.most_light,
        _seen=seen_fields(rays, wide_grid.nodes, circles, tangents),
        _colors=tuple(colors),
    )


def _moves(rays, nodes, aperture_radius, ratio):
    """Return movements of the rays of a camera's own opening, as `LensRays.moves`."""
    moves, chief = rays.moves(nodes)
    moves = moves * aperture_radius
    moves[..., 0] *= rays.stretch / ratio
    return moves, chief


def _rim_slopes(rims, orders):
    """Return how fast clearances change over the iris where they are 0, for each node; the least.

    Parameters
    ----------
    rims : ndarray of shape (S, 2 T, P)
    orders : ndarray of int, shape (T, 2)

    Returns
    -------
    slopes : ndarray of shape (S, P)
    least : ndarray of shape (S,)
        Clearance at any of the places that are looked at.
    """
    count = _GRADIENT_PLACES
    places = spread_places(count)
    steps = np.array([(0.0, 0.0), (_NUDGE, 0.0), (0.0, _NUDGE)])
    terms = disc_terms(orders, (places + steps[:, None]).reshape(-1, 2)).reshape(3 * count, -1)
    slopes, least = [], []
    for rim in rims:
        at, right, up = (terms @ rim).reshape(3, count, -1)
        slope = np.hypot(right - at, up - at) / _NUDGE
        near = np.exp(-np.abs(at) / 0.1) + 1e-9
        slopes.append(np.maximum((slope * near).sum(axis=0) / near.sum(axis=0), 1e-6))
        least.append(at.min())
    return np.array(slopes).reshape(len(rims), rims.shape[-1]), np.array(least)
