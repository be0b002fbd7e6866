"""Slices of a scene for depth layers: from cuts to clip planes, from pictures of slices to layers.

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
# Coverage of a pixel that nothing is seen through: a sample's share may be lost in rounding.
_WHOLE = 1.0 - 1e-4
# Least difference of coverage between two layers of which each has another part of a pixel.
_UNLIKE = 0.02
# Longest side of the picture that depths in view are measured in, px.
MEASURED_SIDE = 512
# Overlap of slices that are denoised: a denoiser draws some pixels of a ragged end wrongly.
DENOISED_OVERLAP = 0.3
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


def plan_slices(
    count, nearest, farthest, clip_start, clip_end, orthographic=False, overlap=OVERLAP
):
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
    overlap : float
        Share of a layer by which its slice goes on behind its far cut.

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
        end = min(_overlapped(cuts[number], cuts[number + 1], orthographic, overlap), clip_end)
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
    known = is_surface(depth)
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


def mending(coverage_before, coverage):
    """Return the factor that keeps a surface that crosses a cut from counting as transparent twice.

    Where the overlap is narrower than a pixel, the surface covers parts of the pixel in both
    layers, and laid over each other they would let through what is behind: half of a half. There
    the farther layer covers the whole pixel, as the surface does. Edges of objects are not such
    places: on a surface that goes on, pixels on one side are whole in the one layer only, and on
    the other side in the other only.

    Parameters
    ----------
    coverage_before, coverage : ndarray of shape (height, width)
        Of the layer in front and of this one, as rendered.

    Returns
    -------
    ndarray of float32, of the same shape
        At least 1.
    """
    whole_before, whole = coverage_before >= _WHOLE, coverage >= _WHOLE
    partly = (coverage_before > 0.0) & (coverage > 0.0) & ~whole_before & ~whole
    partly &= coverage_before + coverage >= _WHOLE
    partly &= _near(whole_before & ~whole) & _near(whole & ~whole_before)
    return np.divide(1.0, coverage, out=np.ones_like(coverage, np.float32), where=partly)


def kept_ends(coverage, behind):
    """Find the pixels of a layer that must not fade, though their depth is behind its cut.

    Where a surface goes through the cut within a pixel, each layer has a part of it; the depth of
    the pixel is that of some place in it. Edges of objects, which have to fade, lie in both layers
    alike.

    Parameters
    ----------
    coverage, behind : ndarray of shape (height, width)
        Of the layer and of the next one, as rendered.

    Returns
    -------
    ndarray of bool, of the same shape
    """
    partly = (coverage > 0.0) & (coverage < _WHOLE) & (behind > 0.0) & (behind < _WHOLE)
    return partly & (coverage + behind >= _WHOLE) & (np.abs(coverage - behind) > _UNLIKE)


def is_surface(depth):
    """Whether a renderer's depth is one, for each pixel."""
    return np.isfinite(depth) & (depth > 0.0) & (depth < NOTHING)


def _near(found, pixels=2):
    """Whether something was found in the pixel or nearby: as far as pixel filters reach."""
    padded = np.pad(found, pixels)
    height, width = found.shape
    side = range(2 * pixels + 1)
    return np.any([padded[y : y + height, x : x + width] for y in side for x in side], axis=0)


def _steps(orthographic, depth):
    """Return a measure of depth in which the circle of confusion is linear."""
    return depth if orthographic else -1.0 / np.asarray(depth, np.float64)


def _overlapped(near, far, orthographic, overlap):
    if orthographic:
        return far + overlap * (far - near)
    inverse = 1.0 / far - overlap * (1.0 / near - 1.0 / far)
    # The last layer but one of a deep scene may reach beyond any distance.
    return 1.0 / inverse if inverse > 0.0 else math.inf
