"""The depth at a place of a captured picture."""

import numpy as np

# Pixels on each side of the one that is asked for: a surface's edge or noise moves no focus.
_REACH = 1


def depth_at(stack, x, y):
    """Return the depth at a place of the picture: of the foremost layer that covers it.

    Layers in front may cover a part of the pixel only (hair, edges): the layer counts behind which
    less than half of what is seen lies. Its depth is the median of the pixels around that it
    covers.

    Parameters
    ----------
    stack : LayerStack
    x, y : float
        In pixels of the picture, from its lower left corner.

    Returns
    -------
    float or None
        In m along the optical axis; inf where the world is seen, None outside the picture or where
        there is nothing.
    """
    if not (0.0 <= x < stack.width and 0.0 <= y < stack.height):
        return None
    column, row = int(x) + stack.overscan[0], int(y) + stack.overscan[1]
    covers = np.clip([layer.color[row, column, 3] for layer in stack.layers], 0.0, 1.0)
    seen = covers * np.cumprod(np.concatenate([[1.0], 1.0 - covers[:-1]]))
    if not seen.any():
        return None
    foremost = int(np.argmax(np.cumsum(seen) >= 0.5 * seen.sum()))
    layer = stack.layers[foremost]
    around = (
        slice(max(row - _REACH, 0), row + _REACH + 1),
        slice(max(column - _REACH, 0), column + _REACH + 1),
    )
    depths = layer.depth[around][layer.color[around][..., 3] > 0.0]
    found = depths[np.isfinite(depths)]
    return float(np.median(found)) if found.size else float("inf")
