"""Word wrapping of sentences in panels: Blender's labels have one line and are cut off."""

import textwrap

_PIXELS_PER_LETTER = 6.5
_LEAST_LETTERS = 12


def letters_across(context):
    """Return how many letters fit into a line of the properties editor.

    Parameters
    ----------
    context : bpy.types.Context

    Returns
    -------
    int
    """
    scale = _PIXELS_PER_LETTER * context.preferences.system.ui_scale
    return max(24, int(context.region.width / scale) - 7)


def draw_sentences(column, text, letters, icon="NONE"):
    """Draw a text over as many lines as it takes.

    Parameters
    ----------
    column : bpy.types.UILayout
    text : str
    letters : int
        Of a line.
    icon : str
        Stands before the first line.
    """
    room = letters - 3 if icon != "NONE" else letters
    for i, line in enumerate(textwrap.wrap(text, max(room, _LEAST_LETTERS)) or [""]):
        column.label(text=line, icon="BLANK1" if i and icon != "NONE" else icon)


def draw_alert(column, text, letters):
    """Draw a text in red, with the sign of an error; see `draw_sentences`."""
    for i, line in enumerate(textwrap.wrap(text, max(letters - 3, _LEAST_LETTERS))):
        row = column.row()
        row.alert = True
        row.label(text=line, icon="BLANK1" if i else "ERROR")
