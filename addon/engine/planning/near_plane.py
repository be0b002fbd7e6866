"""The near plane of a frame's depth buffer: as far away as what is in view allows.

Steps of depth grow with the square of the distance over the near plane's. With the clip start of a
few millimetres that cameras close to things have, surfaces some metres away would lie within a
step of one another, and which of them is seen would be chance. Nothing nearer than the nearest
surface in view has to fit between the planes; the far one stays, because what is empty has its
depth.
"""

import numpy as np

from ...levels.choosing import extents
from ...sampling.pixel_filter import filter_support

# Of the depth of the nearest bounding box in view: coarser levels of detail may reach a little
# farther than the meshes that bounds are of.
_ROOM = 0.5
# Boxes that are looked at at once, those first that begin nearest.
_AT_ONCE = 1 << 10
# Edges of a box, by the numbers of its corners.
_EDGES = np.array([(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit])


def with_near_plane(snapshot):
    """Return a camera's projection with a near plane as far away as can be.

    Parameters
    ----------
    snapshot : SceneSnapshot
        All of its picture counts, so that parts of it are drawn alike.

    Returns
    -------
    ndarray of shape (4, 4)
        Camera space to clip space of the whole picture; that of the camera for a parallel
        projection, whose steps of depth are all the same.
    """
    projection = snapshot.camera.projection
    slope, offset = (float(v) for v in projection[2, 2:])
    if snapshot.camera.orthographic or snapshot.stack is not None:
        return projection
    near = offset / (slope - 1.0)
    # In single precision, a far plane many times as far as the near one is infinitely far.
    far = offset / (slope + 1.0) if slope < -1.0 else np.inf
    found = _ROOM * nearest_in_view(snapshot, near)
    if not near < found < far:
        return projection
    fitted = np.array(projection, np.float64)
    ratio = found / far
    fitted[2, 2:] = -(1.0 + ratio) / (1.0 - ratio), -2.0 * found / (1.0 - ratio)
    return fitted


def nearest_in_view(snapshot, near):
    """Return a depth that nothing in view of any lens sample falls below.

    Parameters
    ----------
    snapshot : SceneSnapshot
    near : float
        Depth of the camera's near plane, m; what is nearer is not in view.

    Returns
    -------
    float
        In m, `near` at least; inf if nothing is in view.
    """
    content, view = snapshot.content, snapshot.camera.view
    seen = extents(content.boxes, view)
    ahead = seen.farthest > near
    nearest = np.maximum(seen.nearest, near)
    if not _sees_straight(snapshot.camera):
        return float(nearest[ahead].min(initial=np.inf))
    lens, planes, found = snapshot.camera.lens, list(_sides(snapshot)), np.inf
    for plane in planes:
        # Most boxes of a large scene are beside the picture in whole.
        across = plane @ view
        middle, reach = content.boxes.range_along(across[:3])
        moved = np.max(_moved(plane, lens, np.stack([nearest, seen.farthest])), axis=0)
        ahead &= middle + across[3] + reach + moved >= 0.0
    ahead = np.flatnonzero(ahead)
    nearest = nearest[ahead]
    order = np.argsort(nearest)
    for first in range(0, len(order), _AT_ONCE):
        rows = order[first : first + _AT_ONCE]
        if nearest[rows[0]] >= found:
            break
        corners = content.boxes.corners(ahead[rows]) @ view[:3, :3].T + view[:3, 3]
        inside = [_nearest_inside(corners, near, plane, lens) for plane in planes]
        found = min(found, float(np.max(inside, axis=0).min()))
    return max(found, near)


def _sees_straight(camera):
    """Whether a sample's view is that of a pinhole beside the lens' middle."""
    return camera.chromatic is None and camera.real_lens is None and camera.artist is None


def _sides(snapshot):
    """Return the planes between which a pinhole in the lens' middle sees, widened by the filter."""
    film, rows = snapshot.film, snapshot.camera.projection
    support = filter_support(film.filter_kind, film.filter_size_px)
    for axis, size in enumerate((film.width, film.height)):
        reach = 1.0 + support / size
        yield reach * rows[3] + rows[axis]
        yield reach * rows[3] - rows[axis]


def _moved(plane, lens, depths):
    """Return how far the lens moves points of given depths across a plane, at most."""
    if lens is None or not lens.aperture_radius:
        return np.zeros_like(depths)
    extent = lens.aperture_radius * np.array([1.0 / lens.iris.ratio, 1.0])
    return np.abs(plane[:2]) @ extent * np.abs(1.0 - depths / lens.focus_distance)


def _nearest_inside(corners, near, plane, lens):
    """Return the least depth of boxes on the inner side of a plane, shape (I,); inf where none is.

    Parameters
    ----------
    corners : ndarray of shape (I, 8, 3)
        In camera space.
    near : float
        Depth of the near plane, m.
    plane : ndarray of shape (4,)
    lens : ThinLens or None
    """
    depth = -corners[..., 2]
    inside = corners @ plane[:3] + plane[3]
    if lens is not None and lens.aperture_radius:
        # How far the lens moves a point is convex in its depth, so that what is between the ends of
        # a box moves less than the straight line between theirs.
        ends = np.stack([np.maximum(depth.min(axis=1), near), depth.max(axis=1)])
        moved = _moved(plane, lens, ends)
        share = (depth - ends[0, :, None]) / np.maximum(np.ptp(ends, axis=0), 1e-30)[:, None]
        inside = inside + moved[0, :, None] + (moved[1] - moved[0])[:, None] * share
    nearest = np.where(inside >= 0.0, depth, np.inf).min(axis=1, initial=np.inf)
    a, b = _EDGES.T
    across = inside[:, a] * inside[:, b] < 0.0
    share = inside[:, a] / np.where(across, inside[:, a] - inside[:, b], 1.0)
    crossing = depth[:, a] + (depth[:, b] - depth[:, a]) * share
    return np.minimum(nearest, np.where(across, crossing, np.inf).min(axis=1, initial=np.inf))
