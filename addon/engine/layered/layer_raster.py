"""The raster that depth layers have, and depths in the values of a frame's depth buffer."""

from dataclasses import dataclass

import numpy as np

# Texels of all layers together, and along a side of a pixel: what is in focus is as smooth as the
# pixel filter makes it only where texels are finer than pixels.
_MOST_TEXELS = 1 << 25
_FINEST = 3
# Parts of a texel along each side that shapes are drawn in, and of all texels together: edges lie
# between texels, and that of a horizon is one for a whole row of pixels.
_PARTS, _MOST_PARTS = 3, 1 << 24
_LONGEST = 8192


@dataclass(frozen=True)
class LayerRaster:
    """The raster of the layers.

    Parameters
    ----------
    width, height : int
        In texels.
    fine : int
        Texels along a side of a pixel.
    margin : tuple of 2 int
        Pixels beyond the frame on the left and right, at the bottom and the top.
    parts : int
        That shapes of slices are drawn in, along each side of a texel.
    """

    width: int
    height: int
    fine: int
    margin: tuple[int, int]
    parts: int = 1


def layer_raster(plan, nearest, farthest):
    """Choose the raster of the layers.

    Parameters
    ----------
    plan : FramePlan
        With `layered`.
    nearest, farthest : float
        Depths between which there is something, m.

    Returns
    -------
    LayerRaster
    """
    reach = plan_reach(plan, nearest, farthest)
    margin = tuple(int(min(np.ceil(side), plan.layered.overscan)) for side in reach)
    width, height = plan.width + 2 * margin[0], plan.height + 2 * margin[1]
    slices = plan.layered.count * len(plan.layered.eyes)
    affordable = int(np.sqrt(_MOST_TEXELS / (width * height * slices)))
    fine = int(np.clip(affordable, 1, _FINEST))
    width, height = width * fine, height * fine
    parts = 1
    if not plan.layered.peeled:
        # What is peeled lies behind single parts: texels of several surfaces would be mixed.
        parts = min(int(np.sqrt(_MOST_PARTS / (width * height))), _LONGEST // max(width, height))
        parts = int(np.clip(parts, 1, _PARTS))
    return LayerRaster(width, height, fine, margin, parts)


def plan_reach(plan, nearest, farthest):
    """Return how far beyond the frame samples between two depths see, across and up, in pixels.

    That is the largest parallax over the lens, and what the smallest picture of all wavelengths
    shows more than the frame holds.
    """
    moved, wider = np.zeros(2), np.zeros(2)
    sweeps = [plan.sweep]
    if plan.chromatic:
        base, gain = plan.sweep_parts
        field = plan.chromatic.overall()
        sweeps = [base + gain * focus for focus in field.inverse_focus]
        smallest = min(float(field.scale[0]), 1.0)
        scale, offset = plan.chromatic.raster[:2], plan.chromatic.raster[2:]
        # From the axis to the farther side; a lens that is shifted has it beside the middle.
        sides = np.stack([offset, offset + scale * (plan.width, plan.height)]) / scale
        wider = (1.0 / smallest - 1.0) * np.abs(sides).max(axis=0)
    for sweep in sweeps:
        for depth in (window_depth(plan, nearest), window_depth(plan, farthest)):
            moved = np.maximum(moved, np.abs(plan.lens_extent * (sweep[:2] + sweep[2:] * depth)))
    if plan.real_lens is not None:
        scale = np.abs(np.diag(plan.projection)[:2]) * (plan.width, plan.height) / 2.0
        moved += plan.real_lens.bound(nearest) * scale
    return moved + wider


def window_depth(plan, depth):
    """Return the value of a frame's depth buffer for a depth in m."""
    clip = plan.projection @ np.array([0.0, 0.0, -depth, 1.0])
    return float(clip[2] / clip[3]) * 0.5 + 0.5


def depth_in_window(plan, value):
    """Return the depth in m that a value of a frame's depth buffer stands for."""
    slope, offset = plan.projection[2, 2:]
    ndc = 2.0 * value - 1.0
    return float((offset - ndc) / slope if plan.orthographic else offset / (ndc + slope))


def clipped_projection(projection, near, far):
    """Return a projection with other near and far planes, m.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
    near, far : float

    Returns
    -------
    ndarray of shape (4, 4)
    """
    found = np.array(projection, np.float64)
    if found[3, 2] == 0.0:
        found[2, 2:] = -2.0 / (far - near), -(far + near) / (far - near)
    else:
        found[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
    return found


def clip_planes(projection):
    """Return the depths of the near and the far plane of a projection, m."""
    slope, offset = projection[2, 2:]
    if projection[3, 2] == 0.0:
        return (offset + 1.0) / slope, (offset - 1.0) / slope
    return offset / (slope - 1.0), offset / (slope + 1.0) if slope != -1.0 else np.inf


@dataclass(frozen=True, eq=False)
class DeviceLayers:
    """Depth layers on the device.

    Parameters
    ----------
    textures : Targets
        See `passes.layered.layers.specs`, with pyramids.
    raster : LayerRaster
    count : int
        Layers.
    nearest : float
        Depth of the nearest surface, m.
    filtered : bool
        Colours are filtered pictures: alpha is the share of a texel that is covered, and they are
        mixed between texels; else a texel is one place of one surface.
    """

    textures: object
    raster: LayerRaster
    count: int
    nearest: float
    filtered: bool
