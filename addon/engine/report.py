"""Warnings about a frame: the one list for final render, viewport and command line.

A warning is a line that names the data-block, says what is wrong, and what is drawn instead.
Warnings come from reading the scene (`SceneContent.report`, `Camera.report`) and from drawing
(`FrameRenderer.report`). `frame_report` gathers them; the final render gives them to Blender and to
the listener's `RenderOutcome` (``--json``, ``--stats``, ``--strict``), the viewport shows the
first, and *Render > Report* all of them.
"""

import re

# The number of copies in a warning, which may change from frame to frame.
_COUNT = re.compile(r" \(\d+ copies\)$")
# The kind of the data-block that a warning begins with, and what may be the end of its name.
_KIND = re.compile(r"(object|material|image|camera|world|scene|view layer) '")
_END = re.compile(r"'(?=: | )")


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


def subject_of(line, is_there=None):
    """Return the data-block that a warning is about.

    Parameters
    ----------
    line : str
    is_there : callable or None
        Whether there is a data-block, by kind and name: names and what is said of them may have
        quotes, and the longest name counts that there is. None takes the shortest.

    Returns
    -------
    kind, name : str
        In Blender's words, in lower case: ``"object"``, ``"view layer"``; and the full name, with
        the library of what is linked. Both empty if the line begins with none of them.
    """
    found = _KIND.match(line)
    if not found:
        return "", ""
    kind = found[1]
    names = [line[found.end() : end.start()] for end in _END.finditer(line, found.end())]
    if not names:
        return "", ""
    there = (name for name in reversed(names) if is_there and is_there(kind, name))
    return kind, next(there, names[0])


def one_line(error):
    """Return the message of an exception in one line."""
    return " ".join(str(error).split())


def failure(error):
    """Return in one line what an exception that is a fault of Aplanat says of itself."""
    told = one_line(error)
    what = f"{type(error).__name__}: {told}" if told else type(error).__name__
    return f"Aplanat failed ({what}); the console tells where"
