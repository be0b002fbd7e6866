"""The noise threshold: settings that are chosen from it before a frame is drawn.

The threshold is an error of the picture, 1 - SSIM. The number of lens samples is found while they
are drawn, from the picture itself (`sampling.tile_control`, `engine.frame.tile_sampling`). Errors
that more samples do not reduce must be small from the start: levels of detail and shared drawings
are therefore the finer the smaller the threshold is.
"""

import math
from dataclasses import replace

import numpy as np

from ...levels.choosing import coc_ends, extents
from ...sampling.subsamples import FIRST_INTERVAL

LEAST_ERROR = 1e-4
_SUBSAMPLES = 4
# Least movement, px, across a subsample's cell that leaves its texel; see
# ``passes/subsample_frag.glsl``.
_LEAST_MOVE_PX = 0.5

# Boxes that are looked at at once.
_AT_ONCE = 1 << 10
# Threshold below which levels of detail get finer, as levels blur vertex colours.
_BIAS_AT = 0.02
# Threshold up to which shared drawings have four cells along a pixel instead of two; with two,
# edges in focus have 4 steps.
_FINE_CELLS_BELOW = 0.005


def settle(sampling, snapshot, plan):
    """Choose subsamples, level bias and cells of shared drawings from the target error.

    Parameters
    ----------
    sampling : Sampling
    snapshot : SceneSnapshot
    plan : FramePlan
        A plan with any number of samples.

    Returns
    -------
    Sampling
        Without `target_error`; the number of lens samples is as it was.
    """
    error = sampling.target_error
    if error is None:
        return sampling
    error = max(error, LEAST_ERROR)
    # The part of the lens that a sample of the first round stands for, in pixels of the largest
    # blur. Later rounds have smaller parts.
    moved = largest_coc(snapshot.content, plan) / math.sqrt(FIRST_INTERVAL)
    return replace(
        sampling,
        target_error=None,
        subsamples=_SUBSAMPLES if moved > _LEAST_MOVE_PX else 0,
        reuse_grid=sampling.reuse_grid and (2 if error > _FINE_CELLS_BELOW else 4),
        level_bias=sampling.level_bias + max(0.0, math.log2(_BIAS_AT / error)),
    )


def largest_coc(content, plan):
    """Return the largest circle of confusion in the frame.

    It is found from the bounding boxes of the objects, clipped to the frustum.

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
    seen = extents(content.boxes, plan.view, plan.chromatic)
    depths = (np.maximum(depth, 1e-6) for depth in (seen.nearest, seen.farthest))
    bound = np.abs(coc_ends(*depths, plan, seen.inverse_focus)).max(axis=0)
    # With a parallel projection all pixels show the same point of the world: nothing to blur.
    shows_world = bool(content.world.image) and not plan.orthographic
    largest = abs(plan.empty_coc) if shows_world else 0.0
    # By falling upper bound, until no other can be larger.
    order = np.argsort(-bound, kind="stable")
    for first in range(0, len(order), _AT_ONCE):
        rows = order[first : first + _AT_ONCE]
        if bound[rows[0]] <= largest:
            break
        corners = content.boxes.corners(rows) @ plan.view[:3, :3].T + plan.view[:3, 3]
        for place in np.flatnonzero(_may_be_inside(corners, plan.projection)).tolist():
            row = rows[place]
            if bound[row] <= largest:
                break
            depths = _depths_inside(corners[place], plan.projection)
            if depths is not None:
                focus = None if seen.inverse_focus is None else seen.inverse_focus[:, row]
                ends = np.abs(coc_ends(*depths, plan, focus))
                largest = max(largest, float(ends.max()))
    return largest


def _may_be_inside(corners, projection):
    """Return which boxes, shape (R, 8, 3), lie on the outer side of no plane of the frustum."""
    clip = corners @ projection[:, :3].T + projection[:, 3]
    outside = (clip[..., 3:] + clip[..., :3] < 0.0).all(axis=1)
    outside |= (clip[..., 3:] - clip[..., :3] < 0.0).all(axis=1)
    return ~outside.any(axis=1)


def _depths_inside(corners, projection):
    """Return the depth range of the part of a box inside the frustum, or None.

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
