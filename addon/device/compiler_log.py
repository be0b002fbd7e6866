"""Messages of the driver's shader compiler, mapped back to files and lines of the sources.

Blender hands the compiler's messages to the console of the process, not to Python. A shader that
was refused is therefore compiled once more with the console caught.
"""

import os
import re
import sys
import tempfile
from contextlib import contextmanager

from . import shader_source

# A stage's heading, and its messages: line and column of the text given to Blender.
_STAGE = re.compile(r"\b(Vert|Frag|Comp)Shader:")
_MESSAGE = re.compile(r"python_shader\.glsl:(\d+)(?::\d+)?: ?(.*)")
_MOST_MESSAGES = 5


@contextmanager
def caught_console():
    """Catch what is written to the console of the process, also by C code; yields a list of str."""
    text = []
    with tempfile.TemporaryFile() as file:
        kept = []
        try:
            sys.stdout.flush()
            sys.stderr.flush()
            for descriptor in (1, 2):
                kept.append((descriptor, os.dup(descriptor)))
                os.dup2(file.fileno(), descriptor)
            yield text
        finally:
            for descriptor, copy in kept:
                os.dup2(copy, descriptor)
                os.close(copy)
            file.seek(0)
            text.append(file.read().decode(errors="replace"))


def locate_messages(console, stages):
    """Find a compiler's messages in its output, and map their lines to shader files.

    Parameters
    ----------
    console : str
    stages : dict of str to str
        The text of ``"Vert"``, ``"Frag"`` and ``"Comp"``.

    Returns
    -------
    str
        ``file:line: message``, the first few, separated by semicolons; empty where nothing was
        understood.
    """
    found, stage = [], ""
    for line in console.splitlines():
        heading = _STAGE.search(line)
        if heading:
            stage = heading.group(1)
        message = _MESSAGE.search(line)
        if message:
            place = shader_source.locate(stages.get(stage, ""), int(message.group(1)))
            found.append(f"{place}: {message.group(2).strip()}")
    return "; ".join(dict.fromkeys(found[:_MOST_MESSAGES]))
