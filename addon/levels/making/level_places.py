"""Positions of merged places: quadric error minimisation.

A merged place minimises the sum of squared distances from the planes of the triangles round its
group, weighted by their area: Garland's quadrics, solved for the whole group at once.

References
----------
Garland and Heckbert, *Surface simplification using quadric error metrics*, SIGGRAPH 1997.
"""

import numpy as np

# Weight of the perpendicular plane through a border or seam, relative to its triangle's.
_BORDER_WEIGHT = 10.0
# Regularisation: share of the quadric's trace, without borders, that pulls a merged place to the
# mean of its group.
_PULL = 0.003
# Weight of the direction along a seam, relative to its triangle's: along a curved seam its planes
# meet at ill-defined points, so places keep the mean of their group along it.
_HOLD_ALONG_SEAMS = 2.0


def merged_places(surface, groups):
    """Return the positions of merged places.

    Parameters
    ----------
    surface : Surface
    groups : ndarray of shape (P,)
        The new place of each old one.

    Returns
    -------
    ndarray of shape (G, 3)
    """
    normal, length = surface.normal, surface.size
    center = surface.points.mean(axis=0) if len(surface.points) else np.zeros(3)
    points = surface.points - center
    count = int(groups.max(initial=-1)) + 1
    sizes = np.bincount(groups, minlength=count)
    mean = np.stack([np.bincount(groups, v, count) for v in points.T])
    mean /= np.maximum(sizes, 1)
    moving = sizes > 1
    quadric = np.zeros((6, count))
    pull = np.zeros((3, count))
    _add_planes(quadric, pull, groups, moving, surface.faces, points, normal, length)
    trace = quadric[0] + quadric[3] + quadric[5]
    hold = np.where(trace > 0.0, _PULL * trace, 1.0)
    border, owner = surface.borders
    if len(border):
        across = normal[:, owner] / np.maximum(length[owner], 1e-300)
        _add_planes(
            quadric, pull, groups, moving, border, points, *_through(points, border, across)
        )
    held = quadric.copy()
    if len(surface.seams):
        across = _place_normals(surface)[:, surface.seams].sum(axis=2)
        across /= np.maximum(np.sqrt(np.square(across).sum(axis=0)), 1e-300)
        planes = _through(points, surface.seams, across)
        _add_planes(quadric, pull, groups, moving, surface.seams, points, *planes)
        held = quadric.copy()
        along = (points[surface.seams[:, 1]] - points[surface.seams[:, 0]]).T
        size = np.square(along).sum(axis=0)
        along *= _HOLD_ALONG_SEAMS * np.sqrt(size)
        unused = np.zeros((3, count))
        weight = _HOLD_ALONG_SEAMS * size
        _add_planes(held, unused, groups, moving, surface.seams, points, along, weight)
    for row in (0, 3, 5):
        held[row] += hold
    move = _move(quadric, held, pull, mean)
    # Clamped to the extent of the group: nearly parallel planes meet far away.
    spread = sum(np.square(x - m[groups]) for x, m in zip(points.T, mean, strict=True))
    farthest = np.zeros(count)
    np.maximum.at(farthest, groups, spread)
    distance = np.square(move).sum(axis=0)
    move *= np.sqrt(np.minimum(farthest / np.maximum(distance, 1e-300), 1.0))
    moved = mean + move
    return np.where(moving, moved, mean).T + center


def _through(points, edges, across):
    """Return the perpendicular planes through border or seam edges, and their weights.

    Parameters
    ----------
    points : ndarray of shape (P, 3)
    edges : ndarray of shape (E, 2)
    across : ndarray of shape (3, E)
        Unit normals of the surface there.
    """
    outward = np.cross(points[edges[:, 1]] - points[edges[:, 0]], across.T).T
    weight = np.sqrt(np.square(outward).sum(axis=0))
    # Weighted by its square, against a vector as long as itself.
    return _BORDER_WEIGHT * weight * outward, _BORDER_WEIGHT * weight**2


def _place_normals(surface):
    normal = np.zeros((3, len(surface.points)))
    for total, values in zip(normal, surface.normal, strict=True):
        for corner in surface.faces.T:
            total += np.bincount(corner, values, len(surface.points))
    return normal


def _add_planes(quadric, pull, groups, moving, corners, points, normal, weight):
    """Add the quadrics of planes to the groups at their corners, once for each group.

    Parameters
    ----------
    quadric : ndarray of shape (6, G)
        Upper triangles of the matrices; changed.
    pull : ndarray of shape (3, G)
        Right sides; changed.
    groups : ndarray of shape (P,)
    moving : ndarray of shape (G,)
        bool; groups that get planes.
    corners : ndarray of shape (T, k)
        Places that each plane goes through.
    points : ndarray of shape (P, 3)
    normal : ndarray of shape (3, T)
        Normals, of the length of the plane's weight.
    weight : ndarray of shape (T,)
    """
    count = quadric.shape[1]
    target = []
    for corner in corners.T:
        group = groups[corner]
        # A plane is added once to a group, however many of its corners are in it.
        once = moving[group]
        for other in target:
            once &= other != group
        target.append(np.where(once, group, count))
    share = 1.0 / np.maximum(weight, 1e-300)
    through = points[corners[:, 0]]
    offset = sum(n * x for n, x in zip(normal, through.T, strict=True)) * share

    def add(into, values):
        for group in target:
            into += np.bincount(group, values, count + 1)[:count]

    row = 0
    for i in range(3):
        add(pull[i], normal[i] * offset)
        scaled = normal[i] * share
        for j in range(i, 3):
            add(quadric[row], scaled * normal[j])
            row += 1


def _move(quadric, held, pull, mean):
    """Solve held x = pull - quadric mean by cofactors; regularisation makes that stable."""
    xx, xy, xz, yy, yz, zz = quadric
    mx, my, mz = mean
    bx = pull[0] - (xx * mx + xy * my + xz * mz)
    by = pull[1] - (xy * mx + yy * my + yz * mz)
    bz = pull[2] - (xz * mx + yz * my + zz * mz)
    xx, xy, xz, yy, yz, zz = held
    # Of one size, so that no product of three overflows or vanishes.
    size = 1.0 / np.maximum(xx + yy + zz, 1e-300)
    xx, yy, zz = xx * size, yy * size, zz * size
    xy, xz, yz = xy * size, xz * size, yz * size
    bx, by, bz = bx * size, by * size, bz * size
    cxx, cxy, cxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    cyy, cyz, czz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    determinant = xx * cxx + xy * cxy + xz * cxz
    return (
        np.stack(
            [
                cxx * bx + cxy * by + cxz * bz,
                cxy * bx + cyy * by + cyz * bz,
                cxz * bx + cyz * by + czz * bz,
            ]
        )
        / determinant
    )
