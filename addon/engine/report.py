"""Warnings about a frame: the one list for final render, viewport and command line.

A warning is a line that names the data-block, says what is wrong, and what is drawn instead.
Warnings come from reading the scene (`SceneContent.report`, `Camera.report`) and from drawing
(`FrameRenderer.report`). `frame_report` gathers them; the final render gives them to Blender and to
the listener's `RenderOutcome` (``--json``, ``--stats``, ``--strict``), the viewport shows the
first.
"""

import re

# The number of copies in a warning, which may change from frame to frame.
_COUNT = re.compile(r" \(\d+ copies\)$")


def frame_report(snapshot, renderer=None):
    """Return the warnings of a frame, each once.

    Parameters
    ----------
    snapshot : SceneSnapshot
    renderer : FrameRenderer or None
        None before anything is drawn.

    Returns
    -------
    tuple of str
    """
    drawn = renderer.report if renderer is not None else ()
    return tuple(dict.fromkeys([*snapshot.camera.report, *snapshot.content.report, *drawn]))


def without_count(line):
    """Return a warning without its number of copies, so that an animation shows it once."""
    return _COUNT.sub("", line)


def in_short(lines):
    """Summarise warnings for a status line: their number and the first; "" without any."""
    if not lines:
        return ""
    if len(lines) == 1:
        return f"Warning: {lines[0]}"
    return f"{len(lines)} warnings, the first: {lines[0]}"
