"""Functions of the field as functions of the place in the picture, for each place of the iris."""

import numpy as np

from .disc_terms import disc_terms

_FIT_PLACES = 200
# Steps to the field of the ray that lands at a place: what share of the way each goes.
_LANDING_STEPS = (1.0, 1.0, 0.5, 0.5)
_GOLDEN_ANGLE = 2.399963229728653


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
    places = spread_places(_FIT_PLACES)
    terms = disc_terms(orders, places).reshape(len(places), -1)
    middle = disc_terms(orders, np.zeros((1, 2))).reshape(1, -1)
    shift = np.tensordot(terms - middle, moves, 1)
    values = np.moveaxis(terms @ every, 0, -1)
    seen = np.broadcast_to(wanted, (len(places), *wanted.shape))
    for step in _LANDING_STEPS:
        there = _of_each(shift, grid, seen)
        seen = seen + step * (wanted - there - seen)
    moved = _of_each(values, grid, seen)
    return np.linalg.pinv(terms) @ np.moveaxis(moved, -1, 0)


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
