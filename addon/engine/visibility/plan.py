"""Visibility of a frame's highlights: parameters, atlas of masks, choice of the method by cost.

Masks have about a texel for each pixel of the disc. The atlas has a size that does not depend on
the number of highlights: where there are many, their masks are smaller, so that the cost of all
masks is bounded.
"""

from dataclasses import dataclass

import numpy as np

from ...passes.bokeh import highlights
from ...passes.visibility import culling
from ...passes.visibility.cones import CLUSTER

# Cost in steps of a ray (7 to 8 ns each on software OpenGL): of a triangle in a mask, a triangle in
# a layer, and a texel of a layer.
STEPS_PER_TRIANGLE = 8
STEPS_PER_DRAWN = 8
STEPS_PER_TEXEL = 4
# Triangles that are counted for an instance of a transparent surface.
_SURFACE_TRIANGLES = 64
# The square root of 3: the spline with which masks are read then blurs as a pixel does.
_MASK_TEXELS_PER_PIXEL = 1.73
# Most texels of the atlas, and its longest side.
LARGEST_ATLAS = 1 << 25
LONGEST_ATLAS = 16384


@dataclass
class VisibilityCounts:
    """Numbers of sources by the results of the visibility tests, and the cost of their masks.

    Attributes
    ----------
    outside, hidden, visible, free, masked : int
        Sources whose disc is outside the frame; hidden from the whole lens; without a surface of
        the layers in front; without triangles in their cone; and those that are left.
    empty, whole : int
        Of the hidden and of the visible sources, those that were found by their masks.
    pairs, surface_pairs : int
        Pairs of source and cluster of opaque triangles, and of source and transparent instance.
    work : int
        Steps of rays that masks by WARP take.
    texels : int
        Texels of all masks.
    method : str
        RASTER, WARP or SPLAT; empty if no source is left.
    """

    outside: int = 0
    hidden: int = 0
    visible: int = 0
    free: int = 0
    masked: int = 0
    empty: int = 0
    whole: int = 0
    pairs: int = 0
    surface_pairs: int = 0
    work: int = 0
    texels: int = 0
    method: str = ""

    @property
    def triangles(self):
        """Triangles that masks by RASTER take, without transparent surfaces."""
        return self.pairs * CLUSTER


def note(found, room=LARGEST_ATLAS):
    """Return the counts of a table of counts, as `VisibilityCounts`.

    Parameters
    ----------
    found : ndarray of shape (N,)
        See `passes.visibility.culling`.
    room : int
        Texels that masks may take; where they are made smaller, less is walked.

    Returns
    -------
    VisibilityCounts
    """
    states = culling.STATES.items()
    masks = found[culling.COUNT_SIZES :][: culling.SIZES].astype(np.int64)
    asked_for = int((masks * _sides(len(masks)) ** 2).sum())
    made = int((masks * lay_out(masks, room).sizes[:, 2] ** 2).sum())
    return VisibilityCounts(
        **{name: sum(int(found[place]) for place in places) for name, places in states},
        work=64 * int(found[culling.COUNT_WORK]) * made // max(asked_for, 1),
        pairs=int(found[culling.COUNT_PAIRS]),
        surface_pairs=int(found[culling.COUNT_GROUPS :].sum()),
    )


def choose(counts, method, layers):
    """Choose the method of the masks by cost.

    Parameters
    ----------
    counts : VisibilityCounts
    method : {'AUTO', 'RASTER'}
        The camera's setting.
    layers : int
        Cost of the layers, in steps of rays.

    Returns
    -------
    str
        Empty where no source is left.
    """
    if counts.masked == 0:
        return ""
    if method != "AUTO":
        return method
    triangles = counts.triangles + counts.surface_pairs * _SURFACE_TRIANGLES
    return "RASTER" if triangles * STEPS_PER_TRIANGLE <= counts.work + layers else "WARP"


def layers_cost(triangles, texels, layers):
    """Return the cost of drawing the peeled layers, in steps of rays.

    Parameters
    ----------
    triangles : int
        Of the scene.
    texels : int
        Of a layer.
    layers : int

    Returns
    -------
    int
    """
    return layers * (triangles * STEPS_PER_DRAWN + texels * STEPS_PER_TEXEL)


def visibility_params(plan, fine=1, reach=1.0):
    """Return the values of `VisibilityParams` for a frame.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    fine : int
        Texels of the layers along a side of a pixel.
    reach : float
        Extent of a disc in units of its radius.

    Returns
    -------
    dict of str to sequence of float or ndarray
    """
    bokeh = plan.bokeh
    projection = bokeh.projection
    raster = np.array([bokeh.width, bokeh.height]) * fine
    slope, offset = projection[2, 2:]
    focus = plan.focus_distance
    if plan.orthographic:
        start = (1.0 + offset) / slope
        depth = (0.5 + 0.5 * offset, -0.5 * slope)
        rate = -2.0 / (slope * focus)
    else:
        start = offset / (slope - 1.0)
        depth = (0.5 - 0.5 * slope, 0.5 * offset)
        rate = -2.0 / offset
    sweep = np.diag(projection)[:2] * raster / 2.0 * rate
    return {
        "view": plan.view,
        "projection": projection,
        "lens": (focus, float(plan.orthographic), plan.coc_scale, bokeh.iris.ratio),
        "opening": (*plan.lens_extent, start, reach),
        "raster": (*raster, fine, highlights.SAME_VIEW),
        "frame": (*bokeh.margin, plan.width, plan.height),
        "sweep": (*sweep, *depth),
        "tiles": (
            culling.SIZES,
            culling.LEAST_SIDE,
            _MASK_TEXELS_PER_PIXEL,
            _reaching_depth(plan),
        ),
        "colors": _colors(bokeh.colors, focus),
        # Captured pictures are filtered.
        "layers": (float(bool(plan.layered and plan.layered.stack)), 0.0, 0.0, 0.0),
    }


def _colors(colors, focus_distance):
    if colors is None:
        return (0.0, 0.0, 0.0, focus_distance)
    return (*colors.focus_changes[:2], colors.growth, colors.focus_distance)


def _reaching_depth(plan):
    """Return the depth, m, up to which discs are wider than the raster's margin around the frame.

    A surface outside the raster at a larger depth is blurred too little to reach into the frame,
    so it occludes no part of a disc inside the frame.
    """
    margin = min(plan.bokeh.margin)
    colors = plan.bokeh.colors
    if colors is not None:
        # The wavelength that is blurred most, moved to the frame by the lateral scale.
        margin -= colors.growth * max(plan.bokeh.width, plan.bokeh.height)
        focus = 1.0 / plan.focus_distance + colors.focus_changes[0]
        away = margin / plan.coc_scale
        # Infinitely far where the margin is too narrow at every depth.
        reach = (1.0 - away) / focus if plan.orthographic else 1.0 / max(focus + away, 1e-9)
        return max(reach, 0.0)
    if plan.orthographic:
        return max(plan.focus_distance * (1.0 - margin / plan.coc_scale), 0.0)
    return 1.0 / (1.0 / plan.focus_distance + margin / plan.coc_scale)


@dataclass(frozen=True, eq=False)
class AtlasLayout:
    """Layout of the masks of each size in the atlas.

    Parameters
    ----------
    width, height : int
        Size of the atlas, texels.
    sizes : ndarray of shape (SIZES, 4)
        For each size of mask: number of masks before it, y of its first row, side, masks a row.
    """

    width: int
    height: int
    sizes: np.ndarray

    def packed(self):
        """Return the bytes of a `TileLayout`."""
        atlas = (self.width, self.height, 0.0, 0.0)
        return culling.TILE_LAYOUT.pack(atlas=atlas, sizes=self.sizes)


def lay_out(numbers, most_texels=LARGEST_ATLAS):
    """Lay out an atlas; where masks do not fit, larger ones are made smaller.

    Parameters
    ----------
    numbers : sequence of int
        Number of masks of each size.
    most_texels : int

    Returns
    -------
    AtlasLayout
    """
    numbers = np.asarray(numbers, np.int64)
    sides = _sides(len(numbers))
    largest = sides[-1]
    while (numbers * sides**2).sum() > most_texels and largest > culling.LEAST_SIDE // 4:
        largest //= 2
        sides = np.minimum(sides, largest)
    return _stack(numbers, sides)


def _sides(kinds):
    """Return the sides of masks of each size where there is room for all, texels."""
    return culling.LEAST_SIDE << np.arange(kinds)


def lay_out_more(layout, before, numbers):
    """Add masks to a layout above those that it has, which stay in place.

    Parameters
    ----------
    layout : AtlasLayout
    before : int
        Number of masks of the layout.
    numbers : sequence of int
        Number of further masks of each size.

    Returns
    -------
    AtlasLayout
        With the further sizes behind the others.
    """
    more = _stack(np.asarray(numbers, np.int64), layout.sizes[:, 2].astype(np.int64))
    sizes = more.sizes + np.array([before, layout.height, 0.0, 0.0])
    return AtlasLayout(
        max(layout.width, more.width),
        layout.height + more.height,
        np.concatenate([layout.sizes, sizes]),
    )


def _stack(numbers, sides):
    texels = max(int((numbers * sides**2).sum()), 1)
    widest = int(sides[numbers > 0].max(initial=culling.LEAST_SIDE))
    width = min(max(1 << int(np.ceil(np.log2(texels) / 2)), widest), LONGEST_ATLAS)
    layout = np.zeros((len(numbers), 4))
    height = 0
    for size, (number, side) in enumerate(zip(numbers, sides, strict=True)):
        each = max(width // side, 1)
        layout[size] = numbers[:size].sum(), height, side, each
        height += -(-number // each) * side
    return AtlasLayout(width, max(int(height), 1), layout)
