"""What one lens sample sees, triangle by triangle: the twin of `surface` and `data` of the passes.

A pixel belongs to the nearest triangle that covers its middle. Values are interpolated linearly in
the world, that is, divided by the clip coordinate w on the way.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Sight:
    """What the pixels of a region see.

    Parameters
    ----------
    triangle : ndarray of shape (height, width)
        int, -1 where nothing is.
    position : ndarray of shape (height, width, 3)
        In world space.
    depth : ndarray of shape (height, width)
        Along the axis, in m.
    margin : ndarray of shape (height, width)
        How far the pixel's middle is from the nearest edge of any triangle in front of which
        nothing nearer lies, in pixels: a rasteriser may decide otherwise where it is small.
    """

    triangle: np.ndarray
    position: np.ndarray
    depth: np.ndarray
    margin: np.ndarray


def displace(eye, lens_xy, focus_distance):
    """Move points of camera space to where the place `lens_xy` on the lens sees them.

    Parameters
    ----------
    eye : ndarray of shape (..., 3)
    lens_xy : array_like of shape (2,)
        In m.
    focus_distance : float

    Returns
    -------
    ndarray of shape (..., 3)
    """
    moved = np.array(eye, np.float64)
    factor = (focus_distance + moved[..., 2:]) / focus_distance
    moved[..., :2] -= np.asarray(lens_xy) * factor
    return moved


def rasterize(corners, plan, lens_xy=(0.0, 0.0), jitter=(0.0, 0.0)):
    """Rasterise triangles as a lens sample sees them.

    Parameters
    ----------
    corners : ndarray of shape (T, 3, 3)
        In world space, all in front of the camera.
    plan : FramePlan
    lens_xy : sequence of 2 float
        Place on the lens, in m.
    jitter : sequence of 2 float
        In clip units.

    Returns
    -------
    Sight
    """
    corners = np.asarray(corners, np.float64)
    eye = corners @ plan.view[:3, :3].T + plan.view[:3, 3]
    moved = displace(eye, lens_xy, plan.focus_distance)
    homogeneous = np.concatenate([moved, np.ones((*moved.shape[:2], 1))], axis=-1)
    clip = homogeneous @ plan.projection.T
    w = clip[..., 3]
    size = np.array([plan.width, plan.height])
    raster = (clip[..., :2] / w[..., None] + np.asarray(jitter) + 1.0) / 2.0 * size
    y, x = np.mgrid[: plan.height, : plan.width] + 0.5
    shape = (plan.height, plan.width)
    nearest = np.full(shape, np.inf)
    triangle = np.full(shape, -1)
    position = np.zeros((*shape, 3))
    margin = np.full(shape, np.inf)
    for index in range(len(corners)):
        weights, distance = _barycentric(raster[index], x, y)
        perspective = weights / w[index]
        total = perspective.sum(axis=-1, keepdims=True)
        perspective /= np.where(total == 0.0, 1.0, total)
        depth = -(perspective @ eye[index, :, 2])
        inside = (weights >= 0.0).all(axis=-1)
        hit = inside & (depth < nearest)
        nearest[hit] = depth[hit]
        triangle[hit] = index
        position[hit] = (perspective @ corners[index])[hit]
        margin = np.minimum(margin, distance)
    return Sight(triangle, position, nearest, margin)


def _barycentric(raster, x, y):
    a, b, c = raster
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    weights, distances = [], []
    for p, q in ((b, c), (c, a), (a, b)):
        edge = (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
        weights.append(edge / area)
        along = np.clip(
            ((x - p[0]) * (q[0] - p[0]) + (y - p[1]) * (q[1] - p[1])) / ((q - p) @ (q - p)), 0, 1
        )
        distances.append(
            np.hypot(x - p[0] - along * (q[0] - p[0]), y - p[1] - along * (q[1] - p[1]))
        )
    return np.stack(weights, axis=-1), np.minimum.reduce(distances)
