"""Numpy twin of the merging of highlights (`passes.bokeh.clusters`)."""

import numpy as np

AXES = np.array([[-29.0, -14.0, 22.0], [26.0, -13.0, 26.0], [-2.0, 34.0, 19.0]]) / 39.0
SHIFT = np.array([0.37, 0.61, 0.17])
HARM_RADIUS = 8.0


def coc_radius(depth, lens):
    """Signed radius of the circle of confusion, px; `lens` as in `ViewParams`."""
    defocus = lens[2] * (depth - lens[0]) / lens[0]
    return defocus if lens[1] else defocus / depth


def cells(sources, regions, view, lens, pixel, side, level, shift, length=1.0):
    """Return the cell of each source.

    Parameters
    ----------
    sources : ndarray of shape (N, 4)
        x, y, depth, m, and extent, px.
    regions : ndarray of shape (N,)
        Of the lens.
    view : ndarray of shape (4, 4)
    lens : tuple of float
    pixel : float
        Side of a pixel 1 m away (orthographic: anywhere), m.
    side : float
        Of the cells of level 0, in radii of the circle of confusion.
    level, shift : float
    length : float
        Of a cell along the camera's axis, in sides.

    Returns
    -------
    ndarray of shape (N, 5)
        Place along the cells' axes, logarithm of the side, region.
    """
    depth = sources[:, 2]
    radius = np.abs(coc_radius(depth, lens)) * pixel * (1.0 if lens[1] else depth)
    scale = np.floor(np.log2(np.maximum(side * radius, 1e-30)) + level)
    eye = np.column_stack([sources[:, :2], -depth / length, np.ones(len(depth))])
    world = (eye @ np.linalg.inv(view).T)[:, :3]
    place = np.floor(world @ AXES.T / 2.0 ** scale[:, None] + SHIFT + shift)
    return np.column_stack([place, scale, regions]).astype(np.int64)


def merge(sources, energies, groups, lens, pixel, extent, harm):
    """Merge the sources of each group, where that is harmless.

    Parameters
    ----------
    sources : ndarray of shape (N, 4)
    energies : ndarray of shape (N, 4)
        Red, green, blue, region.
    groups : ndarray of shape (N, ...)
        Equal for the sources of a group.
    lens : tuple of float
    pixel : float
    extent, harm : float
        See `passes.bokeh.clusters.Similarity`.

    Returns
    -------
    sources, energies : ndarray of shape (M, 4)
        In the order of the first of each group.
    """
    _, first, group = np.unique(groups, axis=0, return_index=True, return_inverse=True)
    group = group.ravel()
    sources, energies = sources.copy(), energies.copy()
    kept = np.ones(len(sources), bool)
    for number, leader in enumerate(first):
        members = np.flatnonzero(group == number)
        if len(members) < 2:
            continue
        one, energy = _together(sources[members], energies[members], lens, pixel)
        coc = abs(coc_radius(one[2], lens))
        peak = energy.max() / (np.pi * coc**2)
        if one[3] <= extent * coc and peak * one[3] ** 2 / (HARM_RADIUS * coc) <= harm:
            kept[members] = False
            kept[leader] = True
            sources[leader] = one
            energies[leader, :3] = energy
    return sources[kept], energies[kept]


def _together(sources, energies, lens, pixel):
    weight = energies[:, :3].max(axis=1)
    weight = weight / weight.sum()
    place = sources[:, :3].copy()
    if not lens[1]:
        place = np.column_stack([place[:, :2], np.ones(len(place))]) / place[:, 2:]
    mean = weight @ place
    variance = weight @ (((place - mean)[:, :2] / pixel) ** 2).sum(axis=1)
    rate = lens[2] / lens[0] if lens[1] else lens[2]
    radii = weight @ (rate * (place - mean)[:, 2]) ** 2
    side = np.sqrt(weight @ sources[:, 3] ** 2 + 6.0 * variance + 12.0 * radii)
    if not lens[1]:
        mean = np.append(mean[:2], 1.0) / mean[2]
    return np.append(mean, side), energies[:, :3].sum(axis=0)


def cluster(sources, energies, similarity, view, lens, pixel):
    """Merge similar sources level by level, as `passes.bokeh.clusters.cluster` without pairs.

    Parameters
    ----------
    sources, energies : ndarray of shape (N, 4)
    similarity : Similarity
    view : ndarray of shape (4, 4)
    lens : tuple of float
    pixel : float

    Returns
    -------
    sources, energies : ndarray of shape (M, 4)
    """
    sources, energies = np.asarray(sources, float), np.asarray(energies, float)
    for level in range(1, similarity.levels + 1):
        for shift in (0.0, 0.5):
            energy_regions = energies[:, 3]
            shape = (similarity.cell, level, shift, similarity.length)
            own = cells(sources, energy_regions, view, lens, pixel, *shape)
            sources, energies = merge(
                sources, energies, own, lens, pixel, similarity.extent, similarity.harm
            )
    return sources, energies
