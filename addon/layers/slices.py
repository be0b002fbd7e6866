"""Slices of a scene for depth layers: from cuts to clip planes, and from a renderer's picture of a
slice to a layer.

A slice goes on behind its far cut by `OVERLAP` of the layer, and fades there: a surface that
crosses the cut is seen whole in one layer where it is partly seen, or partly denoised, in the
other.
"""

import math
from dataclasses import dataclass

import numpy as np

from .cuts import OVERLAP, layer_cuts

# Where in the overlap a layer begins to fade, and is gone: before, so that the near edge of the
# next layer is covered by whole pixels; the rest keeps the slice's own ragged edge out of sight.
FADE_BEGIN, FADE_END = 0.5, 0.75
# Renderers' depth of nothing; Blender's is 1e10.
NOTHING = 1e9
# Below this share of the depth, a range of depths is cut no further.
_LEAST_RANGE = 1e-3


@dataclass(frozen=True)
class Slice:
    """What is rendered for one layer.

    Parameters
    ----------
    near, far : float
        Bounds of the layer, m: 0 for the foremost, inf for the last.
    clip_start, clip_end : float
        Of the camera, m.
    orthographic : bool
    """

    near: float
    far: float
    clip_start: float
    clip_end: float
    orthographic: bool = False

    def weights(self, depth):
        """Return how much of a surface belongs to this layer: less than 1 in the overlap.

        Parameters
        ----------
        depth : ndarray
            In m; inf where there is nothing.

        Returns
        -------
        ndarray of float32, of the same shape
        """
        if math.isinf(self.far):
            return np.ones_like(depth, np.float32)
        begin, end = _steps(self.orthographic, self.far), _steps(self.orthographic, self.clip_end)
        with np.errstate(divide="ignore", invalid="ignore"):
            place = (_steps(self.orthographic, depth) - begin) / (end - begin)
        weights = np.clip((FADE_END - place) / (FADE_END - FADE_BEGIN), 0.0, 1.0)
        return np.where(np.isfinite(depth), weights, 1.0).astype(np.float32)


def plan_slices(count, nearest, farthest, clip_start, clip_end, orthographic=False):
    """Return the slices of a picture, the foremost first.

    The first begins at the camera's near plane and the last ends at its far plane, so that nothing
    is lost that was not seen when the depths were measured.

    Parameters
    ----------
    count : int
        Layers wanted; of a scene that is as good as flat there is one.
    nearest, farthest : float
        Depths of the surfaces in view, m; `nearest` is inf where there are none.
    clip_start, clip_end : float
        Of the camera, m.
    orthographic : bool

    Returns
    -------
    list of Slice
    """
    nearest, farthest = max(nearest, clip_start), min(farthest, clip_end)
    # A parallel projection may begin behind the camera, where no lens sees anything in focus.
    flat = not nearest < farthest * (1.0 - _LEAST_RANGE) or nearest <= 0.0
    if count == 1 or flat or not math.isfinite(farthest):
        return [Slice(0.0, math.inf, clip_start, clip_end, orthographic)]
    cuts = [float(cut) for cut in layer_cuts(count, nearest, farthest, orthographic)]
    slices = []
    for number in range(count):
        near = cuts[number] if number else 0.0
        start = near or clip_start
        if number == count - 1:
            slices.append(Slice(near, math.inf, start, clip_end, orthographic))
            continue
        end = min(_overlapped(cuts[number], cuts[number + 1], orthographic), clip_end)
        slices.append(Slice(near, cuts[number + 1], start, end, orthographic))
    return slices


def filled_depth(depth, coverage, otherwise):
    """Return a depth for every pixel that is covered, and inf elsewhere.

    Renderers tell the depth of one sample of a pixel, which may have missed what the others hit:
    then the nearest of the neighbours' depths is as good.

    Parameters
    ----------
    depth : ndarray of shape (height, width)
        In m; not finite, or `NOTHING` and more, where there is none.
    coverage : ndarray of shape (height, width)
    otherwise : float
        Depth of what is covered far from any known depth (smoke has none), m.

    Returns
    -------
    depth : ndarray of float32, of the same shape
    guessed : int
        Pixels that `otherwise` was taken for.
    """
    covered = coverage > 0.0
    known = np.isfinite(depth) & (depth > 0.0) & (depth < NOTHING)
    found = np.where(known & covered, depth, np.inf).astype(np.float32)
    # Blackman-Harris and other filters reach no farther than two pixels.
    for _ in range(2):
        open_ = covered & np.isinf(found)
        if not open_.any():
            break
        padded = np.pad(found, 1, constant_values=np.inf)
        height, width = found.shape
        shifted = [padded[y : y + height, x : x + width] for y in range(3) for x in range(3)]
        found = np.where(open_, np.min(shifted, axis=0), found)
    guessed = covered & np.isinf(found)
    found[guessed] = otherwise
    return found, int(guessed.sum())


def _steps(orthographic, depth):
    """Return a measure of depth in which the circle of confusion is linear."""
    return depth if orthographic else -1.0 / np.asarray(depth, np.float64)


def _overlapped(near, far, orthographic):
    if orthographic:
        return far + OVERLAP * (far - near)
    inverse = 1.0 / far - OVERLAP * (1.0 / near - 1.0 / far)
    # The last layer but one of a deep scene may reach beyond any distance.
    return 1.0 / inverse if inverse > 0.0 else math.inf
