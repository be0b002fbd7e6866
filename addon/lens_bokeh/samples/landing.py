"""Functions of the field as functions of the place in the picture, for each place of the iris."""

from functools import lru_cache

import numpy as np

from .disc_terms import disc_orders, disc_terms
from .field_grid import FieldGrid

# Nodes that are looked at around a grid, for the rays that land in it.
_PADDING = 4
# Steps along one side of the axis, over those of a grid.
_FINER = 0.5
# Places of the iris for each term.
_FIT_PLACES = 4
# Steps to the field of the ray that lands at a place: what share of the way each goes.
_LANDING_STEPS = (1.0, 1.0, 0.5, 0.5)
_GOLDEN_ANGLE = 2.399963229728653


def landed(rays, aperture_radius, grid, wanted):
    """Return light and clearances of the rims by the places of the picture where rays land.

    Parameters
    ----------
    rays : LensRays, CylinderRays or ArtistRays
    aperture_radius : float
        m.
    grid : FieldGrid
        Over the picture.
    wanted : ndarray of shape (P, 2)
        Places of the picture, tangents.

    Returns
    -------
    ndarray of shape (1 + S, 2 T, P)
        Of points in focus; as of `LensRays.light_and_rims`.
    """
    if rays.of_revolution:
        return _turned(rays, aperture_radius, grid, wanted)
    around = grid.padded(_PADDING)
    return _on_grid(rays, aperture_radius, around, wanted)


def _on_grid(rays, aperture_radius, around, wanted):
    every = rays.light_and_rims(around.nodes)
    powers = (rays.focus_vergence / rays.largest_vergence) ** np.arange(4)
    moves = np.einsum("tnkc,k->tnc", rays.moves(around.nodes)[0] * aperture_radius, powers)
    # As the lens has them, without the anamorphic ratio of the camera.
    return where_they_land(every, moves, rays.orders, around, wanted)


def _turned(rays, aperture_radius, grid, wanted):
    """Look at places to one side of the axis alone, and turn what is found."""
    step = float(((grid.high - grid.low) / (grid.columns - 1, grid.rows - 1)).max()) * _FINER
    away, turn = np.hypot(*wanted.T), np.arctan2(wanted[:, 1], wanted[:, 0])
    nodes = step * np.arange(max(int(np.ceil(away.max() / step)) + 1, _PADDING))
    beyond = int(_PADDING / _FINER)
    low = np.full(2, -beyond * step)
    high = np.array([nodes[-1] + beyond * step, beyond * step])
    strip = FieldGrid(low, high, len(nodes) + 2 * beyond, 2 * beyond + 1)
    places = np.stack([nodes, np.zeros_like(nodes)], axis=-1)
    frequency = rays.orders[:, 1]
    # To the right of the axis there are no sine terms.
    found = _on_grid(rays, aperture_radius, strip, places)[:, : len(frequency)]
    table = np.moveaxis(found, -1, 0)
    # Straight lines: where light ends, values jump.
    cell = np.minimum((away / step).astype(int), len(nodes) - 2)
    share = (away / step - cell)[:, None, None]
    table = table[cell] * (1.0 - share) + table[cell + 1] * share
    angle = turn[:, None, None] * frequency
    turned = np.concatenate([table * np.cos(angle), table * np.sin(angle)], axis=-1)
    return np.moveaxis(turned, 0, -1)


def where_they_land(every, moves, orders, grid, wanted):
    """Move functions of the field to the places of the picture that rays in focus land at.

    Parameters
    ----------
    every : ndarray of shape (K, 2 T, nodes)
        By the field of the points in focus, at the nodes of the grid.
    moves : ndarray of shape (2 T, nodes, 2)
        How far such a point moves, a tangent.
    orders : ndarray of int, shape (T, 2)
        Of the `disc_terms`.
    grid : FieldGrid
    wanted : ndarray of shape (P, 2)
        Places of the picture, tangents.

    Returns
    -------
    ndarray of shape (K, 2 T, P)
        By the place where a ray lands.
    """
    terms, middle, inverse = _fit(int(orders[:, 0].max()))
    shift = np.tensordot(terms - middle, moves, 1)
    values = np.moveaxis(terms @ every, 0, -1)
    seen = np.broadcast_to(wanted, (len(terms), *wanted.shape))
    for step in _LANDING_STEPS:
        there = _of_each(shift, grid, seen)
        seen = seen + step * (wanted - there - seen)
    moved = _of_each(values, grid, seen)
    return inverse @ np.moveaxis(moved, -1, 0)


# Memo of its argument alone, of which there are as many as kinds of lenses.
@lru_cache(maxsize=4)
def _fit(degree):
    """Return the terms at places of the iris, those in its middle, and coefficients of values."""
    orders = disc_orders(degree)
    places = spread_places(_FIT_PLACES * len(orders))
    terms = disc_terms(orders, places).reshape(len(places), -1)
    middle = disc_terms(orders, np.zeros((1, 2))).reshape(1, -1)
    return terms, middle, np.linalg.pinv(terms)


def _of_each(values, grid, seen):
    """Interpolate tables of their own for each row; shape (rows, P, C)."""
    index, weights = grid.taps(seen)
    index += (np.arange(len(seen)) * values.shape[1])[:, None, None]
    flat = values.reshape(-1, values.shape[2])
    return sum(flat.take(index[..., tap], axis=0) * weights[..., tap, None] for tap in range(4))


def spread_places(count):
    """Places of the unit disc, evenly spread."""
    turn = _GOLDEN_ANGLE * np.arange(count)
    radius = np.sqrt((np.arange(count) + 0.5) / count)
    return radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
