"""One number for quality: how many lens samples, subsamples and triangles a frame needs.

The error of an accumulated picture, 1 - SSIM, falls with the number of places on the lens and
grows with the area of the largest circle of confusion, over which they are spread: about
``e = A C^2 / n``.
A subsample counts for less than a sample, since it sees only what its sample sees.
"""

import math
from dataclasses import replace

import numpy as np

from .levels import coc_ends, extents, world_corners

# Measured on three scenes with circles of 55 px (toys, fishes, dragons at 1024 x 576): 62 to 160
# places gave errors of 4.2e-4 to 5.5e-4 times C^2 / n.
_ERROR_OF_PLACE = 5e-4
# Of a sample's worth, 4 subsamples a sample: 16 to 64 samples gave errors of 0.8e-4 to 1.6e-4 times
# C^2 / N on toys and fishes (dragons 2.6e-4, half of it the noise of what it was compared with).
_WORTH_OF_SUBSAMPLE = 0.75
_SUBSAMPLES = 4
# Edges in focus have no blur to smooth them.
_LEAST_SAMPLES = 32
_MOST_SAMPLES = 4096
_LEAST_ERROR = 1e-4

# Levels blur colours that vary from vertex to vertex: the smaller the error, the finer the level.
_BIAS_AT = 0.02
# In cells of half a pixel, edges in focus have 4 steps.
_FINE_CELLS_BELOW = 0.005


def settle(sampling, snapshot, plan):
    """Choose what the target error leaves open.

    Parameters
    ----------
    sampling : Sampling
    snapshot : SceneSnapshot
    plan : FramePlan
        Of any number of samples.

    Returns
    -------
    Sampling
        Without `target_error`.
    """
    error = sampling.target_error
    if error is None:
        return sampling
    error = max(error, _LEAST_ERROR)
    largest = largest_coc(snapshot.content, plan)
    places = _ERROR_OF_PLACE * largest**2 / error
    if plan.chromatic is not None:
        places *= plan.chromatic.samples_for_one
    subsamples = _SUBSAMPLES if places > _LEAST_SAMPLES else 0
    samples = math.ceil(places / (1.0 + _WORTH_OF_SUBSAMPLE * subsamples))
    return replace(
        sampling,
        target_error=None,
        lens_samples=min(max(samples, _LEAST_SAMPLES), _MOST_SAMPLES),
        subsamples=subsamples,
        reuse_grid=sampling.reuse_grid and (2 if error > _FINE_CELLS_BELOW else 4),
        level_bias=sampling.level_bias + max(0.0, math.log2(_BIAS_AT / error)),
    )


def largest_coc(content, plan):
    """Return the largest circle of confusion of what the frame shows.

    Boxes stand for the objects: of each, the part inside the frame counts.

    Parameters
    ----------
    content : SceneContent
    plan : FramePlan

    Returns
    -------
    float
        Radius in pixels.
    """
    if plan.coc_scale == 0.0 or not content.groups:
        return 0.0
    bounds = {group.mesh: content.meshes[group.mesh].bounds for group in content.groups}
    corners = world_corners(content, bounds)
    seen = extents(corners, plan.view, plan.chromatic)
    eye = corners @ plan.view[:3, :3].T + plan.view[:3, 3]
    depths = (np.maximum(depth, 1e-6) for depth in (seen.nearest, seen.farthest))
    bound = np.abs(coc_ends(*depths, plan, seen.inverse_focus)).max(axis=0)
    largest = abs(plan.empty_coc) if content.world.image else 0.0
    # From the largest down, until no other can be larger.
    for row in np.argsort(-bound, kind="stable"):
        if bound[row] <= largest:
            break
        depths = _depths_inside(eye[row], plan.projection)
        if depths is not None:
            focus = None if seen.inverse_focus is None else seen.inverse_focus[:, row]
            ends = np.abs(coc_ends(*depths, plan, focus))
            largest = max(largest, float(ends.max()))
    return largest


def _depths_inside(corners, projection):
    """Return least and largest depth of the part of a box that is in the frame, or None.

    Every face is clipped at the planes of the frustum (Sutherland and Hodgman).
    """
    clip = np.column_stack([corners, np.ones(8)]) @ projection.T
    depth = -corners[:, 2]
    found = []
    for axis in (4, 2, 1):
        for side in (0, axis):
            others = [bit for bit in (1, 2, 4) if bit != axis]
            face = [side, side | others[0], side | others[0] | others[1], side | others[1]]
            polygon = [(clip[i], depth[i]) for i in face]
            for row, sign in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)):
                polygon = _clipped(polygon, row, sign)
            found += [d for _, d in polygon]
    if not found:
        return None
    return min(found), max(found)


def _clipped(polygon, row, sign):
    kept = []
    for (place, depth), (before, depth_before) in zip(
        polygon, polygon[-1:] + polygon[:-1], strict=True
    ):
        inside = place[3] + sign * place[row]
        inside_before = before[3] + sign * before[row]
        if (inside >= 0.0) != (inside_before >= 0.0):
            t = inside / (inside - inside_before)
            kept.append((place + t * (before - place), depth + t * (depth_before - depth)))
        if inside >= 0.0:
            kept.append((place, depth))
    return kept
