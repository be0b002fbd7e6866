"""What of a picture is not as the scene asks: the one list that every way of rendering shows.

A warning is a line that names the data-block, says what is wrong, and what is drawn instead. They
are found where the scene is read (`SceneContent.report`, `Camera.report`) and while the picture is
drawn (`FrameRenderer.report`). `frame_report` gathers them; the final render hands them to Blender
and to the `RenderOutcome` of whoever listens (``--json``, ``--stats``, ``--strict``), the viewport
tells the first of them.
"""

import re

# How many copies of an object a warning is about changes from frame to frame.
_COUNT = re.compile(r" \(\d+ copies\)$")


def frame_report(snapshot, renderer=None):
    """Return the warnings of a frame, each once.

    Parameters
    ----------
    snapshot : SceneSnapshot
    renderer : FrameRenderer or None
        None: nothing has been drawn yet.

    Returns
    -------
    tuple of str
    """
    drawn = renderer.report if renderer is not None else ()
    return tuple(dict.fromkeys([*snapshot.camera.report, *snapshot.content.report, *drawn]))


def without_count(line):
    """Return what a warning says whatever the frame: an animation tells it once."""
    return _COUNT.sub("", line)


def in_short(lines):
    """Return warnings as a piece of a status line: how many, and the first; "" without any."""
    if not lines:
        return ""
    if len(lines) == 1:
        return f"Warning: {lines[0]}"
    return f"{len(lines)} warnings, the first: {lines[0]}"
