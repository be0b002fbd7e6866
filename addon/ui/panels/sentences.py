"""Word wrapping of sentences in panels: Blender's labels have one line and are cut off."""

import blf
import bpy

# Of the widest kind of text, in pixels at a scale of 1; what is drawn is measured.
_PIXELS_PER_LETTER = 6.5
_LEAST_LETTERS = 12
# What a panel keeps free on both sides, with its scroll bar and the gaps of a label, in letters.
_MARGIN_LETTERS = 5
# Of an icon and its gap.
_ICON_LETTERS = 3
# Blender's font of panels.
_FONT = 0


def letters_across(context):
    """Return how many wide letters fit into a line of the properties editor.

    Parameters
    ----------
    context : bpy.types.Context

    Returns
    -------
    int
    """
    scale = _PIXELS_PER_LETTER * context.preferences.system.ui_scale
    return max(24, int(context.region.width / scale) - _MARGIN_LETTERS)


def wrapped(text, letters):
    """Break a text into lines as wide as so many wide letters, by the width of what is drawn.

    Parameters
    ----------
    text : str
    letters : int

    Returns
    -------
    list of str
        At least one; a word that is wider than a line is broken.
    """
    room = _PIXELS_PER_LETTER * max(letters, _LEAST_LETTERS)
    blf.size(_FONT, bpy.context.preferences.ui_styles[0].widget.points)
    lines, line = [], ""
    for word in text.split():
        longer = f"{line} {word}" if line else word
        if _width(longer) <= room:
            line = longer
            continue
        if line:
            lines.append(line)
        *whole, line = _pieces(word, room)
        lines.extend(whole)
    return [*lines, line]


def draw_sentences(column, text, letters, icon="NONE"):
    """Draw a text over as many lines as it takes.

    Parameters
    ----------
    column : bpy.types.UILayout
    text : str
    letters : int
        Of a line; see `letters_across`.
    icon : str
        Stands before the first line.
    """
    room = letters - _ICON_LETTERS if icon != "NONE" else letters
    for i, line in enumerate(wrapped(text, room)):
        column.label(text=line, icon="BLANK1" if i and icon != "NONE" else icon)


def draw_alert(column, text, letters):
    """Draw a text in red, with the sign of an error; see `draw_sentences`."""
    for i, line in enumerate(wrapped(text, letters - _ICON_LETTERS)):
        row = column.row()
        row.alert = True
        row.label(text=line, icon="BLANK1" if i else "ERROR")


def _pieces(word, room):
    """Yield a word in pieces that fit."""
    while _width(word) > room:
        fits = max(1, sum(_width(word[: end + 1]) <= room for end in range(len(word))))
        yield word[:fits]
        word = word[fits:]
    yield word


def _width(text):
    return blf.dimensions(_FONT, text)[0]
