"""Depths at which layers are cut: equal steps of the signed circle of confusion (methods 7)."""

import numpy as np

# Share of a layer by which it goes on behind its far cut: a surface that crosses a cut has no seam.
OVERLAP = 0.1


def layer_cuts(count, nearest, farthest, orthographic=False):
    """Return the depths at which a picture is cut into layers.

    The circle of confusion grows with ``1 / focus - 1 / depth``, for a parallel projection with
    ``depth - focus``: steps that are even in it move a surface of any layer by about as many pixels
    over the lens. Only ratios count, so neither f-number nor resolution matter.

    Parameters
    ----------
    count : int
        Layers, at least 1.
    nearest, farthest : float
        Least and largest depth of anything in view, m; the largest may be inf with perspective.
    orthographic : bool

    Returns
    -------
    ndarray of shape (count + 1,)
        In m, increasing, from `nearest` to `farthest`.

    Raises
    ------
    ValueError
        If the depths are not ``0 < nearest <= farthest``, or no number of layers.

    References
    ----------
    Lee, Eisemann and Seidel, SIGGRAPH Asia 2009, section 4.
    """
    if count < 1:
        raise ValueError(f"{count} layers: at least 1 is needed")
    if not 0.0 < nearest <= farthest:
        raise ValueError(f"depths from {nearest} to {farthest} m are no range in front of the lens")
    steps = np.linspace(0.0, 1.0, count + 1)
    if orthographic:
        if not np.isfinite(farthest):
            raise ValueError("a parallel projection needs a farthest depth")
        return nearest + (farthest - nearest) * steps
    # 1 / depth is linear in the signed circle of confusion, whatever the focus.
    inverse = 1.0 / nearest + (1.0 / farthest - 1.0 / nearest) * steps
    cuts = np.full(count + 1, np.inf)
    np.divide(1.0, inverse, out=cuts, where=inverse > 0.0)
    cuts[0] = nearest
    cuts[-1] = farthest
    return cuts
