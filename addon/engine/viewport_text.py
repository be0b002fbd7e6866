"""Why a 3D view has no picture, written into it: Blender's own text goes with the overlays."""

import textwrap

import blf
import bpy

_FONT = 0
# Of Blender's status text, and to the view's edge, in points.
_SIZE, _MARGIN = 12, 20
# Of the picture that is not there, before the view transform.
_COLOR = (1.0, 0.35, 0.25, 1.0)


def draw(text, area, region):
    """Draw a text over as many lines as it takes, into the frame buffer that is bound.

    Parameters
    ----------
    text : str
    area : bpy.types.Area
    region : bpy.types.Region
        Of the area: the view itself.
    """
    # Pixels in a point.
    scale = bpy.context.preferences.system.ui_scale
    margin = _MARGIN * scale
    # The toolbar lies over the view.
    left = margin + sum(other.width for other in area.regions if other.type == "TOOLS")
    blf.size(_FONT, _SIZE * scale)
    blf.color(_FONT, *_COLOR)
    letter, height = blf.dimensions(_FONT, "n")[0], 1.6 * _SIZE * scale
    across = max(20, int((region.width - left - margin) / letter))
    # Below the header, which lies over the view.
    top = region.height - 4 * margin
    for i, line in enumerate(textwrap.wrap(text, across)):
        blf.position(_FONT, left, top - i * height, 0.0)
        blf.draw(_FONT, line)
