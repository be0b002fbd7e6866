"""How the visibility of a frame's highlights is found: parameters, atlas of masks, choice by cost.

Masks have about a texel for each pixel of the disc. There is room for a number of texels that does
not depend on the number of highlights: where they are many, their masks are smaller, so that the
cost of the masks stays within bounds.
"""

from dataclasses import dataclass

import numpy as np

from ...passes.visibility import culling
from ..drawing.occluders import CLUSTER

# Steps of a ray (7 to 8 ns each on software OpenGL) that take as long as a triangle of a mask, a
# triangle of a layer, and a texel of a layer.
STEPS_PER_TRIANGLE = 8
STEPS_PER_DRAWN = 8
STEPS_PER_TEXEL = 4
# Triangles that stand for an instance that lets light through.
_SURFACE_TRIANGLES = 64
# Surfaces so close before a source that the lens' rim sees them moved by less, in pixels, do not
# part the lens into places that see it and places that do not.
_SAME_VIEW = 0.25
# The square root of 3: the spline that masks are read with then blurs as a pixel does.
_MASK_TEXELS_PER_PIXEL = 1.73
# Texels of the atlas, at most, and its longer side.
LARGEST_ATLAS = 1 << 25
LONGEST_ATLAS = 16384


@dataclass
class VisibilityCounts:
    """What the tests found.

    Attributes
    ----------
    outside, hidden, visible, free, masked : int
        Sources whose disc is outside the frame; that nothing of the lens sees; that no surface of
        the layers lies before; that have no triangles in their cone; that are left.
    empty, whole : int
        Of the hidden and of the visible ones, those that were found by their masks.
    pairs, surface_pairs : int
        Of source and cluster of opaque triangles, of source and instance that lets light through.
    work : int
        Steps of rays that masks by WARP take.
    texels : int
        Of all masks.
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
        """Triangles that masks by RASTER take, without surfaces that let light through."""
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
    """Return which method makes the masks.

    Parameters
    ----------
    counts : VisibilityCounts
    method : {'AUTO', 'RASTER'}
        What is asked for.
    layers : int
        What the layers cost, in steps of rays.

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
    """Return what drawing layers costs, in steps of rays.

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
        How far a disc reaches in units of its radius.

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
        "raster": (*raster, fine, _SAME_VIEW),
        "frame": (*bokeh.margin, plan.width, plan.height),
        "sweep": (*sweep, *depth),
        "tiles": (
            culling.SIZES,
            culling.LEAST_SIDE,
            _MASK_TEXELS_PER_PIXEL,
            _reaching_depth(plan),
        ),
        "colors": _colors(bokeh.colors, focus),
    }


def _colors(colors, focus_distance):
    if colors is None:
        return (0.0, 0.0, 0.0, focus_distance)
    return (*colors.focus_changes[:2], colors.growth, colors.focus_distance)


def _reaching_depth(plan):
    """Return up to which depth discs are wider than what the raster has around the frame, m.

    A surface outside the raster that is farther away, but nearer than a highlight whose own disc is
    not, is seen at no pixel of the frame: it hides nothing of what the frame shows.
    """
    margin = min(plan.bokeh.margin)
    colors = plan.bokeh.colors
    if colors is not None:
        # The wavelength that is blurred most, moved to the frame by the lateral scale.
        margin -= colors.growth * max(plan.bokeh.width, plan.bokeh.height)
        focus = 1.0 / plan.focus_distance + colors.focus_changes[0]
        away = margin / plan.coc_scale
        # Beyond any highlight where even that does not hide it.
        reach = (1.0 - away) / focus if plan.orthographic else 1.0 / max(focus + away, 1e-9)
        return max(reach, 0.0)
    if plan.orthographic:
        return max(plan.focus_distance * (1.0 - margin / plan.coc_scale), 0.0)
    return 1.0 / (1.0 / plan.focus_distance + margin / plan.coc_scale)


@dataclass(frozen=True, eq=False)
class AtlasLayout:
    """Where the masks of each size lie.

    Parameters
    ----------
    width, height : int
        Of the atlas, texels.
    sizes : ndarray of shape (SIZES, 4)
        Of each size: masks of other sizes before, height of the first row, side, masks a row.
    """

    width: int
    height: int
    sizes: np.ndarray

    def packed(self):
        """Return the bytes of a `TileLayout`."""
        atlas = (self.width, self.height, 0.0, 0.0)
        return culling.TILE_LAYOUT.pack(atlas=atlas, sizes=self.sizes)


def lay_out(numbers, most_texels=LARGEST_ATLAS):
    """Lay out an atlas; where the masks are too many, larger ones are made smaller.

    Parameters
    ----------
    numbers : sequence of int
        Masks of each size.
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
    """Lay out more masks above those of a layout, which stay where they are.

    Parameters
    ----------
    layout : AtlasLayout
    before : int
        How many masks it has.
    numbers : sequence of int
        Further masks of each size.

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
