"""Which fields a lens sample sees, and what moves the others: what moves the last that it sees.

A ray that a rim stops may go anywhere: bent far aside, its point would be drawn over what the lens
sample truly sees there, a ghost. So that each place of the picture shows one point only, fields are
followed outwards from the axis until the rims stop their rays, or until these land no farther out
than the ones before, and what lies beyond moves alike.
"""

from dataclasses import dataclass

import numpy as np

# Circles and spokes of fields that are looked at.
_CIRCLES, _SPOKES = 24, 48
# Clearance of a stopped ray from which on its field counts as unseen, in radii of the rim: beyond
# what a softened rim lets through.
UNSEEN = 0.1
# Least growth of the landing place over that of the field; where it is looked at, over the largest
# vergence.
_LEAST_GROWTH, _VERGENCES = 0.1, (0.0, 0.5, 1.0)


@dataclass(frozen=True, eq=False)
class SeenFields:
    """Fields on circles round the axis, for the movements of nodes beyond what is seen.

    Parameters
    ----------
    tangents : ndarray of shape (R + 1,)
        Of the circles, from 0.
    rims : ndarray of shape (S, 2 T, A (R + 1))
        Clearances there: coefficients of the terms; spoke by spoke from the axis.
    away : ndarray of shape (P,)
        Distance of the nodes from the axis, as a tangent.
    spoke : ndarray of shape (P, 2)
        The spokes to both sides of each node.
    share : ndarray of shape (P,)
        Of the second of them.
    """

    tangents: np.ndarray
    rims: np.ndarray
    away: np.ndarray
    spoke: np.ndarray
    share: np.ndarray

    @property
    def count(self):
        """How many fields on circles there are."""
        return _SPOKES * len(self.tangents)

    def reach(self, terms, moves):
        """Return how far out along each spoke samples see, counted in circles.

        Parameters
        ----------
        terms : ndarray of shape (N, 2 T)
        moves : ndarray of shape (N, A (R + 1), 4, 2)
            Of the fields on circles, as of `SampleTables.moves`.

        Returns
        -------
        ndarray of shape (N, A)
        """
        last = len(self.tangents) - 1
        shape = len(terms), _SPOKES, last + 1
        clear = np.full(shape, 1.0)
        if len(self.rims):
            clear = np.min([terms @ rim for rim in self.rims], axis=0).reshape(shape) + UNSEEN
        angles = np.arange(_SPOKES) * (2.0 * np.pi / _SPOKES)
        along = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        moved = np.einsum("narkc,ac->nkar", moves.reshape(*shape, 4, 2), along)
        powers = np.array(_VERGENCES)[:, None] ** np.arange(4)
        growth = (
            1.0
            + np.diff(np.tensordot(moved, powers, (1, 1)), axis=2) / np.diff(self.tangents)[:, None]
        )
        follows = np.ones(shape, bool)
        follows[..., 1:] = growth.min(axis=-1) >= _LEAST_GROWTH
        follows = np.logical_and.accumulate(follows, axis=2)
        before = np.logical_and.accumulate(follows & (clear > 0.0), axis=2).sum(axis=2) - 1
        inner, outer = np.clip(before, 0, last), np.clip(before + 1, 0, last)
        left, right = (
            np.take_along_axis(clear, each[..., None], axis=2)[..., 0] for each in (inner, outer)
        )
        crossing = np.maximum(left, 0.0) / np.maximum(left - right, 1e-12)
        goes_on = np.take_along_axis(follows, outer[..., None], axis=2)[..., 0] & (inner < outer)
        return inner + np.where(goes_on, np.clip(crossing, 0.0, 1.0), 0.0)

    def held(self, values, reach):
        """Let nodes beyond what samples see have the values of the last field before them.

        Parameters
        ----------
        values : ndarray of shape (N, P + A (R + 1), ...)
            At the nodes, then at the fields on circles.
        reach : ndarray of shape (N, A)
            Of `reach`.

        Returns
        -------
        ndarray of shape (N, P, ...)
        """
        nodes, circles = values[:, : len(self.away)], values[:, len(self.away) :]
        last = len(self.tangents) - 1
        limits = np.interp(reach, np.arange(last + 1), self.tangents)
        limit = _between(limits[:, self.spoke[:, 0]], limits[:, self.spoke[:, 1]], self.share)
        beyond = self.away > limit
        if not beyond.any():
            return nodes
        circles = circles.reshape(len(values), _SPOKES, last + 1, -1)
        inner = np.minimum(reach.astype(int), last - 1)
        ends = [
            np.take_along_axis(circles, each[..., None, None], axis=2)[:, :, 0]
            for each in (inner, inner + 1)
        ]
        ends = _between(*ends, (reach - inner)[..., None])
        sample, node = np.nonzero(beyond)
        sides = (ends[sample, self.spoke[node, side]] for side in (0, 1))
        result = nodes.copy()
        at_limit = _between(*sides, self.share[node, None])
        result[sample, node] = at_limit.reshape(-1, *values.shape[2:])
        return result


def fields_on_circles(rays):
    """Return fields on circles round the axis, shape (A (R + 1), 2), spoke by spoke; and radii."""
    tangents = np.tan(np.linspace(0.0, np.arctan(rays.farthest), _CIRCLES + 1))
    angles = np.arange(_SPOKES) * (2.0 * np.pi / _SPOKES)
    spokes = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return (spokes[:, None] * tangents[:, None]).reshape(-1, 2), tangents


def seen_fields(rays, nodes, circles, tangents):
    """Look at what the rims of a lens stop.

    Parameters
    ----------
    rays : LensRays or CylinderRays
    nodes : ndarray of shape (P, 2)
        Fields.
    circles, tangents : ndarray
        Of `fields_on_circles`.

    Returns
    -------
    SeenFields
    """
    rims = rays.light_and_rims(rays.places_shown(circles))[1:]
    turn = np.arctan2(nodes[:, 1], nodes[:, 0]) / (2.0 * np.pi) * _SPOKES
    first = np.floor(turn).astype(int)
    spoke = np.stack([first, first + 1], axis=-1) % _SPOKES
    return SeenFields(tangents, rims, np.hypot(*nodes.T), spoke, turn - first)


def _between(a, b, share):
    return a + (b - a) * share
