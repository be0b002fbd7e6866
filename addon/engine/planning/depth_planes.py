"""The planes of a frame's depth buffer, fitted to what is in view.

Steps of depth grow with the square of the distance over the near plane's. With the clip start of a
few millimetres that cameras close to things have, surfaces some metres away would lie within a
step of one another, and which of them is seen would be chance. Nothing nearer than the nearest
surface in view has to fit between the planes. The far one stays: in perspective, blur has a limit.

The blur of a parallel camera has none, and what is empty has the far plane's depth: with a clip end
of a kilometre it would be blurred a hundred times as widely as all that the frame shows. There the
far plane is fitted, and the near one stays.
"""

import numpy as np

from ...levels.choosing import extents
from ...sampling.pixel_filter import filter_support

# Of the depth of the nearest bounding box in view: coarser levels of detail may reach a little
# farther than the meshes that bounds are of.
_ROOM = 0.5
# The same behind the farthest one in a parallel view, as a share of its distance from the near
# plane; and the least distance of the planes, as a share of that of the camera's own.
_ROOM_BEHIND, _LEAST_SHARE = 0.1, 1e-6
# Boxes that are looked at at once, those first that begin nearest.
_AT_ONCE = 1 << 10
# Edges of a box, by the numbers of its corners.
_EDGES = np.array([(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit])


def with_fitted_planes(snapshot):
    """Return a camera's projection with a near plane as far away as can be, or a far one as near.

    Parameters
    ----------
    snapshot : SceneSnapshot
        All of its picture counts, so that parts of it are drawn alike.

    Returns
    -------
    ndarray of shape (4, 4)
        Camera space to clip space of the whole picture.
    """
    projection = snapshot.camera.projection
    if snapshot.stack is not None:
        return projection
    slope, offset = (float(v) for v in projection[2, 2:])
    if snapshot.camera.orthographic:
        return _with_far_plane(snapshot, (offset + 1.0) / slope, (offset - 1.0) / slope)
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


def _with_far_plane(snapshot, near, far):
    projection = snapshot.camera.projection
    found = farthest_in_view(snapshot, near)
    found += _ROOM_BEHIND * (found - near)
    # Planes need a distance; what lies on the near one has next to none.
    if not near + _LEAST_SHARE * (far - near) < found < far:
        return projection
    fitted = np.array(projection, np.float64)
    fitted[2, 2:] = -2.0 / (found - near), -(found + near) / (found - near)
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
    return max(_first_in_view(snapshot, near, 1.0), near)


def farthest_in_view(snapshot, near):
    """Return a depth that nothing in view of any lens sample exceeds; -inf if nothing is in view.

    Parameters as of `nearest_in_view`.
    """
    return -_first_in_view(snapshot, near, -1.0)


def _first_in_view(snapshot, near, sign):
    """Return the least depth in view times a sign, which tells from where it is looked; or inf."""
    content, view = snapshot.content, snapshot.camera.view
    seen = extents(content.boxes, view)
    ahead = seen.farthest > near
    nearest = np.maximum(seen.nearest, near)
    first = nearest if sign > 0.0 else -seen.farthest
    if not _sees_straight(snapshot.camera):
        return float(first[ahead].min(initial=np.inf))
    lens, planes, found = snapshot.camera.lens, list(_sides(snapshot)), np.inf
    for plane in planes:
        # Most boxes of a large scene are beside the picture in whole.
        across = plane @ view
        middle, reach = content.boxes.range_along(across[:3])
        moved = np.max(_moved(plane, lens, np.stack([nearest, seen.farthest])), axis=0)
        ahead &= middle + across[3] + reach + moved >= 0.0
    ahead = np.flatnonzero(ahead)
    first = first[ahead]
    order = np.argsort(first)
    for start in range(0, len(order), _AT_ONCE):
        rows = order[start : start + _AT_ONCE]
        if first[rows[0]] >= found:
            break
        corners = content.boxes.corners(ahead[rows]) @ view[:3, :3].T + view[:3, 3]
        inside = [_first_inside(corners, near, plane, lens, sign) for plane in planes]
        found = min(found, float(np.max(inside, axis=0).min()))
    return found


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


def _first_inside(corners, near, plane, lens, sign):
    """Return the least depth times `sign` of boxes inside a plane, shape (I,); inf where none is.

    Parameters
    ----------
    corners : ndarray of shape (I, 8, 3)
        In camera space.
    near : float
        Depth of the near plane, m.
    plane : ndarray of shape (4,)
    lens : ThinLens or None
    sign : float
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
    first = np.where(inside >= 0.0, sign * depth, np.inf).min(axis=1, initial=np.inf)
    a, b = _EDGES.T
    across = inside[:, a] * inside[:, b] < 0.0
    share = inside[:, a] / np.where(across, inside[:, a] - inside[:, b], 1.0)
    crossing = sign * (depth[:, a] + (depth[:, b] - depth[:, a]) * share)
    return np.minimum(first, np.where(across, crossing, np.inf).min(axis=1, initial=np.inf))
