"""The surfaces of a captured picture behind one another, as occluders of its highlights."""

import numpy as np

from ...passes.layered.layers import EMPTY

# As many as a texel has channels; see `passes.visibility.visibility_warp`.
_CHANNELS = 4
# Largest difference of depth, as a share of it, of one surface that lies in two layers, since they
# overlap.
_SAME_SURFACE = 1e-3


def occluding_surfaces(stack, depths):
    """Return the foremost surfaces of a captured picture, pixel by pixel.

    A surface that goes through a cut is in both layers there, and one occluder.

    Parameters
    ----------
    stack : LayerStack
    depths : ndarray of shape (layers, height, width)
        Values of the depth buffer; `EMPTY` where nothing is.

    Returns
    -------
    surfaces : ndarray of shape (height, width, 4)
        Their values of the depth buffer, the foremost first.
    opacity : ndarray of shape (height, width, 4)
        How much of the pixel they cover.
    """
    height, width = depths.shape[1:]
    surfaces = np.full((height, width, _CHANNELS), EMPTY, np.float32)
    opacity = np.ones((height, width, _CHANNELS), np.float32)
    count = np.zeros((height, width), int)
    before = np.full((height, width), -np.inf, np.float32)
    for layer, values in zip(stack.layers, depths, strict=True):
        # The world hides nothing.
        there = (values <= 1.0) & np.isfinite(layer.depth)
        alpha = np.clip(layer.color[..., 3], 0.0, 1.0)
        with np.errstate(invalid="ignore"):
            same = there & (np.abs(layer.depth - before) <= _SAME_SURFACE * layer.depth)
        rows, columns = np.nonzero(same & (count > 0) & (count <= _CHANNELS))
        slot = count[rows, columns] - 1
        through = (1.0 - opacity[rows, columns, slot]) * (1.0 - alpha[rows, columns])
        opacity[rows, columns, slot] = 1.0 - through
        other = there & ~same
        rows, columns = np.nonzero(other & (count < _CHANNELS))
        slot = count[rows, columns]
        surfaces[rows, columns, slot] = values[rows, columns]
        opacity[rows, columns, slot] = alpha[rows, columns]
        # Beyond the last channel counting goes on, so that nothing is joined to it.
        count += other
        before = np.where(there, layer.depth, before)
    return surfaces, opacity
