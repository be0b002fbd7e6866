"""Frustum culling of instances, for all lens samples of a frame at once.

The bounding sphere of each instance is tested against the planes of the frustum, widened by the
largest displacement over the lens' opening and the pixel filter: a culled instance cannot touch a
pixel of any sample, so the picture does not change.
"""

import numpy as np

# Drawing a culled instance between two visible ones costs its vertices; leaving it out costs one
# more draw call. Measured on software OpenGL, a draw call is worth about this many triangles.
_TRIANGLES_PER_DRAW_CALL = 100


class BoundingSpheres:
    """Bounding spheres of the instances of a scene, in world space.

    Parameters
    ----------
    content : SceneContent
    bounds : dict of int to ndarray of shape (2, 3)
        Bounding box of each mesh, by uid, in object space.
    """

    def __init__(self, content, bounds):
        world = content.instances.world
        count = len(world)
        self.centers = np.zeros((count, 3))
        self.radii = np.zeros(count)
        for group in content.groups:
            rows = slice(group.first, group.first + group.count)
            low, high = np.asarray(bounds[group.mesh], np.float64)
            matrices = world[rows].astype(np.float64)
            self.centers[rows] = matrices[:, :3, :3] @ ((low + high) / 2) + matrices[:, :3, 3]
            # The Frobenius norm bounds the largest stretch.
            stretch = np.sqrt((matrices[:, :3, :3] ** 2).sum(axis=(1, 2)))
            self.radii[rows] = stretch * np.linalg.norm(high - low) / 2


def seen(spheres, plan, part=None):
    """Return which instances may be visible in any of a frame's lens samples.

    Parameters
    ----------
    spheres : BoundingSpheres
    plan : FramePlan
    part : tuple of 4 int, optional
        x, y, width, height of the part of the raster that is drawn, px; default: all of it.

    Returns
    -------
    ndarray of shape (I,)
        bool.
    """
    eye = spheres.centers @ plan.view[:3, :3].T + plan.view[:3, 3]
    x_row, y_row, z_row, w_row = plan.projection
    w = eye @ w_row[:3] + w_row[3]
    w_reach = np.linalg.norm(w_row[:3]) * spheres.radii
    # |R(d)| over the aperture radius, at its largest inside the sphere.
    shear = (np.abs(plan.focus_distance + eye[:, 2]) + spheres.radii) / plan.focus_distance
    growth = np.zeros(len(eye))
    if plan.chromatic is not None:
        ranges = plan.chromatic.ranges(_boxes(eye, spheres.radii))
        depths = -eye[:, 2] + np.array([[-1.0], [1.0]]) * spheres.radii
        shear = np.abs(1.0 - depths[:, None] * ranges.inverse_focus).max(axis=(0, 1))
        growth = np.abs(ranges.scale - 1.0).max(axis=0)
        growth = growth * (np.linalg.norm(eye[:, :2], axis=1) + spheres.radii)
    if plan.real_lens is not None:
        growth = growth + plan.real_lens.growth(spheres.radii - eye[:, 2])
    jitter = np.abs(plan.jitter).max(axis=0, initial=0.0)
    visible = np.ones(len(eye), bool)
    x, y, across, up = part or (0, 0, plan.width, plan.height)
    sides = (
        (x_row, 0, 2.0 * x / plan.width - 1.0, 2.0 * (x + across) / plan.width - 1.0),
        (y_row, 1, 2.0 * y / plan.height - 1.0, 2.0 * (y + up) / plan.height - 1.0),
        (z_row, None, -1.0, 1.0),
    )
    for row, axis, low, high in sides:
        for plane in (row - low * w_row, high * w_row - row):
            reach = np.linalg.norm(plane[:3]) * spheres.radii
            if axis is not None:
                reach = reach + np.abs(plane[:2]) @ plan.lens_extent * shear
                reach = reach + np.linalg.norm(plane[:2]) * growth
                reach = reach + jitter[axis] * (np.abs(w) + w_reach)
            visible &= eye @ plane[:3] + plane[3] + reach >= 0.0
    return visible


def _boxes(centers, radii):
    corners = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(8, 3)
    return centers[:, None] + radii[:, None, None] * corners


def runs(rows, triangles):
    """Return runs of instance rows, each to be drawn in one call.

    Parameters
    ----------
    rows : ndarray of shape (R,)
        Rising; the visible rows.
    triangles : float
        Triangles of one instance; inf if no culled row may be drawn along.

    Returns
    -------
    list of (int, int)
        First row and number of rows.
    """
    if len(rows) == 0:
        return []
    longest_gap = int(_TRIANGLES_PER_DRAW_CALL / max(triangles, 1))
    breaks = np.flatnonzero(np.diff(rows) > longest_gap + 1)
    starts = rows[np.concatenate([[0], breaks + 1])]
    ends = rows[np.concatenate([breaks, [len(rows) - 1]])]
    return list(zip(starts.tolist(), (ends - starts + 1).tolist(), strict=True))
