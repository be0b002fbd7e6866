"""Merging of small parts of a mesh in its next level of detail: needles, leaves, lamps, pebbles.

A part of a dozen triangles cannot lose half of them and keep its shape. Where a mesh is made of
many such parts they are merged in pairs: one of the pair stays, at the centre of both, with the
area of both and the mean of their colours.

References
----------
Cook, Halstead, Planck and Ryu, *Stochastic simplification of aggregate detail*, SIGGRAPH 2007:
fewer elements that keep the area and the colours of all.
"""

from dataclasses import dataclass

import numpy as np

# Most triangles of a small part; larger ones can be simplified by collapses: an octahedron cannot,
# a ball of twenty triangles can.
_MOST_TRIANGLES = 12
# Least share of a mesh' triangles in small parts for these to be merged: two eyes of a figure stay.
_LEAST_SHARE = 0.25
# Largest distance of a pair, in sums of their radii: parts far apart have other depths and
# backgrounds, and are not merged.
_MOST_DISTANCE = 3.0
# Bits along each axis of the Morton curve on which neighbouring parts are paired.
_CURVE_BITS = 10
# Least extent of a part across its longest axis, as a share of that along it.
_FLAT = 1e-9


def small_parts(surface):
    """Find the parts that are too small for collapses.

    Parameters
    ----------
    surface : Surface

    Returns
    -------
    small : ndarray of shape (N,)
        bool; of each part.
    of_face : ndarray of shape (T,)
        The part of each triangle.
    """
    of_face = surface.parts[surface.faces[:, 0]]
    counts = np.bincount(of_face, minlength=surface.part_count)
    return counts <= _MOST_TRIANGLES, of_face


def paired(surface, small, of_face, slots):
    """Pair the small parts that are merged.

    Parameters
    ----------
    surface : Surface
    small, of_face : ndarray
        See `small_parts`.
    slots : sequence of (int, int, int)
        Material slot, first triangle and count, of the mesh.

    Returns
    -------
    ndarray of shape (C, 2)
        Collapses of places: all places of a removed part into a place of the one that stays. Empty
        where small parts are few.
    """
    chosen = np.flatnonzero(small[of_face])
    if len(chosen) < _LEAST_SHARE * len(of_face):
        return np.empty((0, 2), np.int64)
    slot_of = np.repeat(np.arange(len(slots)), [count for _, _, count in slots])
    count = len(small)
    part, slot = of_face[chosen], slot_of[chosen]
    # Both parts of a pair have the same material.
    low, high = np.full(count, len(slots)), np.full(count, -1)
    np.minimum.at(low, part, slot)
    np.maximum.at(high, part, slot)
    area = np.bincount(part, surface.size[chosen], count)
    center = _centers(surface, chosen, part, area)
    parts = np.flatnonzero((low == high) & (area > 0.0))
    parts = parts[np.lexsort((_along_curve(center[parts]), low[parts]))]
    first, second = parts[:-1:2], parts[1::2]
    apart = np.linalg.norm(center[first] - center[second], axis=1)
    radius = _radii(surface, center, small)
    near = apart <= _MOST_DISTANCE * (radius[first] + radius[second])
    near &= low[first] == low[second]
    first, second = first[near], second[near]
    larger = area[second] > area[first]
    stays = np.where(larger, second, first)
    goes = np.where(larger, first, second)
    anchor = np.full(count, -1, np.int64)
    places = np.flatnonzero(small[surface.parts])[::-1]
    anchor[surface.parts[places]] = places
    target = np.full(count, -1, np.int64)
    target[goes] = anchor[stays]
    moving = np.flatnonzero(target[surface.parts] >= 0)
    return np.stack([target[surface.parts[moving]], moving], axis=1)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of parts that merge on the way to the next level.

    Parameters
    ----------
    passengers : ndarray of shape (P,)
        bool; places of removed parts.
    goes, stays : ndarray of shape (K,)
        The removed and the remaining part of each pair.
    """

    passengers: np.ndarray
    goes: np.ndarray
    stays: np.ndarray


def find_pairs(surface, groups):
    """Find the parts that the groups of a halving merge; None if there are none.

    Parameters
    ----------
    surface : Surface
    groups : ndarray of shape (P,)

    Returns
    -------
    Pairs or None
    """
    parts, count = surface.parts, surface.part_count
    if count < 2:
        return None
    group_count = int(groups.max(initial=-1)) + 1
    low, high = np.full(group_count, count), np.full(group_count, -1)
    np.minimum.at(low, groups, parts)
    np.maximum.at(high, groups, parts)
    if (low == high).all():
        return None
    first, last = np.full(count, group_count), np.full(count, -1)
    np.minimum.at(first, parts, groups)
    np.maximum.at(last, parts, groups)
    whole = first == last
    passengers = (low != high)[groups] & whole[parts]
    carrier = np.full(group_count, -1)
    others = ~passengers
    carrier[groups[others]] = parts[others]
    goes = np.flatnonzero(np.bincount(parts[passengers], minlength=count))
    stays = carrier[first[goes]]
    found = stays >= 0
    return Pairs(passengers, goes[found], stays[found])


def following_parts(surface, groups, pairs):
    """Return the part of each place of the next level.

    Parameters
    ----------
    surface : Surface
    groups : ndarray of shape (P,)
    pairs : Pairs or None

    Returns
    -------
    ndarray of shape (G,)
    """
    result = np.zeros(int(groups.max(initial=-1)) + 1, surface.parts.dtype)
    if pairs is None:
        result[groups] = surface.parts
        return result
    result[groups[pairs.passengers]] = surface.parts[pairs.passengers]
    others = ~pairs.passengers
    result[groups[others]] = surface.parts[others]
    return result


def grown(surface, pairs):
    """Return the new places of the remaining parts, enlarged by the removed ones.

    Parameters
    ----------
    surface : Surface
    pairs : Pairs

    Returns
    -------
    places : ndarray of shape (K,)
    points : ndarray of shape (K, 3)
    moves : float
        Squared displacements of the parts' centres, weighted by twice their areas.
    """
    count = surface.part_count
    _, of_face = small_parts(surface)
    involved = np.zeros(count, bool)
    involved[pairs.goes] = involved[pairs.stays] = True
    faces = np.flatnonzero(involved[of_face])
    part = of_face[faces]
    area = np.bincount(part, surface.size[faces], count)
    center = _centers(surface, faces, part, area)
    share = (area[pairs.goes] / np.maximum(area[pairs.goes] + area[pairs.stays], 1e-300))[:, None]
    target = (1.0 - share) * center[pairs.stays] + share * center[pairs.goes]
    growth = 1.0 + area[pairs.goes] / np.maximum(area[pairs.stays], 1e-300)
    number = np.full(count, -1)
    number[pairs.stays] = np.arange(len(pairs.stays))
    places = np.flatnonzero((number[surface.parts] >= 0) & ~pairs.passengers)
    own = number[surface.parts[places]]
    offset = surface.points[places] - center[pairs.stays][own]
    axes, thin = _axes(offset, own, growth)
    along = np.einsum("kab,kb->ka", axes[own].transpose(0, 2, 1), offset)
    # Columns of axes rise with the extent: the last one is the longest.
    along[:, :2] *= thin[own, None]
    offset = np.einsum("kab,kb->ka", axes[own], along)
    moved = surface.points.copy()
    moved[places] = offset
    stays = number[part] >= 0
    a, b, c = (moved[corner] for corner in surface.faces[faces[stays]].T)
    found = np.bincount(
        number[part[stays]], np.linalg.norm(np.cross(b - a, c - a), axis=1), len(growth)
    )
    wanted = growth * area[pairs.stays]
    offset *= np.sqrt(wanted / np.maximum(found, 1e-300))[own, None]
    moves = sum(
        float((area[part] * np.square(target - center[part]).sum(axis=1)).sum())
        for part in (pairs.goes, pairs.stays)
    )
    return places, target[own] + offset, moves


def mixed(surface, mesh, pairs, values):
    """Return the factors that give the remaining parts the mean colour of their pairs.

    Parameters
    ----------
    surface : Surface
    mesh : MeshSnapshot
    pairs : Pairs
    values : ndarray of shape (V,)
        One channel, not negative.

    Returns
    -------
    factor, summand : ndarray of shape (N,)
        Of each part; the summand is used where the old colour is 0.
    """
    count = surface.part_count
    _, of_face = small_parts(surface)
    involved = np.zeros(count, bool)
    involved[pairs.goes] = involved[pairs.stays] = True
    faces = np.flatnonzero(involved[of_face])
    part = of_face[faces]
    size = surface.size[faces]
    area = np.bincount(part, size, count)
    total = np.bincount(part, size * values[mesh.triangles[faces]].mean(axis=1), count)
    own = total[pairs.stays] / np.maximum(area[pairs.stays], 1e-300)
    both = total[pairs.stays] + total[pairs.goes]
    both /= np.maximum(area[pairs.stays] + area[pairs.goes], 1e-300)
    factor, summand = np.ones(count), np.zeros(count)
    lit = own > 1e-6 * both
    factor[pairs.stays] = np.where(lit, both / np.where(lit, own, 1.0), 1.0)
    summand[pairs.stays] = np.where(lit, 0.0, both - own)
    return factor, summand


def _centers(surface, faces, part, area):
    middle = surface.points[surface.faces[faces]].mean(axis=1)
    weight = surface.size[faces]
    total = np.stack([np.bincount(part, weight * x, len(area)) for x in middle.T], axis=1)
    return total / np.maximum(area, 1e-300)[:, None]


def _radii(surface, center, small):
    """Return the root mean square distance of the places of small parts from their centres."""
    places = np.flatnonzero(small[surface.parts])
    part = surface.parts[places]
    square = np.square(surface.points[places] - center[part]).sum(axis=1)
    count = len(center)
    return np.sqrt(
        np.bincount(part, square, count) / np.maximum(np.bincount(part, minlength=count), 1)
    )


def _axes(offset, part, growth):
    """Return the principal axes of parts, and their growth across the longest axis."""
    count = len(growth)
    moments = np.empty((count, 3, 3))
    for i in range(3):
        for j in range(i, 3):
            moments[:, i, j] = np.bincount(part, offset[:, i] * offset[:, j], count)
            moments[:, j, i] = moments[:, i, j]
    values, axes = np.linalg.eigh(moments)
    across = np.maximum(values[:, 1], _FLAT * np.maximum(values[:, 2], 1e-300))
    slimness = np.sqrt(np.maximum(values[:, 2], 0.0) / np.maximum(across, 1e-300))
    return axes, np.clip(slimness, 1.0, growth)


def _along_curve(points):
    """Return the place of points on a Morton curve."""
    if len(points) == 0:
        return np.empty(0, np.int64)
    low = points.min(axis=0)
    cell = np.maximum((points.max(axis=0) - low).max(), 1e-300) / ((1 << _CURVE_BITS) - 1)
    cells = ((points - low) / cell).astype(np.int64)
    code = np.zeros(len(points), np.int64)
    for bit in range(_CURVE_BITS):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code
