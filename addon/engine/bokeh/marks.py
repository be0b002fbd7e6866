"""The debug view of a frame's bokeh: marks of its sources and their fates (methods 10).

Combined, and the picture of a viewport, then show marks on the dimmed picture; all other passes
are unchanged.
"""

from dataclasses import replace

import numpy as np

from ...device import geometry, readback
from ...device.targets import TargetSpec
from ...device.uniforms import uniform_buffer
from ...passes.bokeh import marks as bokeh_marks
from ...passes.bokeh.marks import Marks

# Colours of the fates of a source, sRGB: those of Blender's strips and collections.
FATE_COLORS = {
    "SHARP": (128, 128, 128),
    "OUTSIDE": (198, 115, 184),
    "HIDDEN": (226, 96, 91),
    "VISIBLE": (123, 204, 123),
    "FREE": (93, 182, 234),
    "MASKED": (241, 163, 85),
    "IN_SPLAT": (141, 89, 218),
}
# Most rings that are drawn, and the number from which on they get fainter.
_MOST_RINGS = 2048
_FEW_RINGS = 256
_RING_OPACITY = 0.5
# Half sides of dots and half widths of lines, in heights of the picture, and their least, px.
_DOT, _LEAST_DOT = 1.0 / 360.0, 1.0
_LINE, _LEAST_LINE = 1.0 / 1440.0, 0.5
# Least circle of confusion, px, where discs that are too sharp to be splatted are listed, too.
_SHARPEST = 1e-6


def mark_targets(plan):
    """Return the render targets of the debug view of a frame.

    Parameters
    ----------
    plan : FramePlan

    Returns
    -------
    list of TargetSpec
        ``marks``, the marks and the marked picture as the picture shows them; empty where the
        debug view is off.
    """
    if not shows_marks(plan):
        return []
    pictures = [TargetSpec(name, "RGBA32F", size=plan.size) for name in ("seen_marks", "marked")]
    return [TargetSpec("marks", "RGBA32F"), *pictures]


def shows_marks(plan):
    """Whether a frame's picture is the debug view."""
    return plan.bokeh is not None and plan.bokeh.settings.debug_view != "NONE"


def with_sharp(bokeh):
    """Return a plan that lists all light above the threshold, however sharp.

    Parameters
    ----------
    bokeh : BokehPlan

    Returns
    -------
    BokehPlan
    """
    return replace(bokeh, least_coc=_SHARPEST, world_share=1.0)


def mark_params(plan, count):
    """Return the values of `MarkParams` for a frame.

    Parameters
    ----------
    plan : FramePlan
    count : int
        Number of sources with a ring.

    Returns
    -------
    dict of str to sequence
    """
    dot = max(_DOT * plan.height, _LEAST_DOT)
    line = max(_LINE * plan.height, _LEAST_LINE)
    opacity = _RING_OPACITY * min(np.sqrt(_FEW_RINGS / min(max(count, 1), _MOST_RINGS)), 1.0)
    colors = [(*map(_linear, FATE_COLORS[fate]), 0.0) for fate in bokeh_marks.FATES]
    colors += [(0.0,) * 4] * (8 - len(colors))
    return {
        "size": (dot, line, opacity, plan.bokeh.iris.ratio),
        "source": (plan.bokeh.least_coc, 0.0, 0.0, 0.0),
        "colors": colors,
    }


def draw_marks(plan, target, view_buffer, listed, merged, visibility, sharp):
    """Draw the marks that a frame asks for.

    Parameters
    ----------
    plan : FramePlan
    target : GPUFrameBuffer
        Gets the marks, premultiplied.
    view_buffer : GPUUniformBuf
        `ViewParams` of the frame.
    listed, merged : tuple of (tuple of 2 GPUTexture, int)
        Sources and their number, before and after merging.
    visibility : Visibility or None
        Visibility of the merged sources; None where there are none.
    sharp : callable
        Returns a list like `listed` of all light above the threshold, to mark what is too sharp.
    """
    kind = plan.bokeh.settings.debug_view
    values = mark_params(plan, merged[1])
    parameters = uniform_buffer(bokeh_marks.MARK_PARAMS.pack(**values))
    square = geometry.square_batch()

    def draw(shape, color, sources, count, stride=1):
        textures = dict(zip(("sources_a_tx", "sources_b_tx"), sources, strict=True))
        if color == "FATES":
            textures |= {"tiles_tx": visibility.tiles, "states_tx": visibility.states}
        marks = Marks(shape, color)
        with target.bind():
            bokeh_marks.draw_marks(square, marks, count, textures, view_buffer, parameters, stride)

    with target.bind():
        target.clear(color=(0.0, 0.0, 0.0, 0.0))
    if kind == "SOURCES":
        draw("DOT", "OWN", *listed)
    else:
        color, shape = ("OWN", "OUTLINE") if kind == "CLUSTERS" else ("FATES", "DOT")
        if kind == "VISIBILITY":
            draw("DOT", "SHARP", *sharp())
        if visibility is not None:
            sources, count = merged
            draw("RING", color, sources, count, -(-count // _MOST_RINGS))
            draw(shape, color, sources, count)
    # The textures that are read may be released only after the device has read them.
    readback.wait(target)


def fates(counts, visibility):
    """Count the sources by fate.

    Parameters
    ----------
    counts : HighlightCounts
    visibility : VisibilityCounts or None

    Returns
    -------
    dict of str to int
        By the names of `passes.bokeh.marks.FATES`.
    """
    numbers = dict.fromkeys(bokeh_marks.FATES, 0) | {"SHARP": counts.culled_size}
    if visibility is not None:
        partly = "IN_SPLAT" if visibility.method == "SPLAT" else "MASKED"
        numbers |= {
            "OUTSIDE": visibility.outside,
            "HIDDEN": visibility.hidden,
            "VISIBLE": visibility.visible,
            "FREE": visibility.free,
            partly: visibility.masked,
        }
    return numbers


def _linear(value):
    value /= 255.0
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
