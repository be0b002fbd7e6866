"""GLSL files: includes resolved once each, and compiler messages mapped back to files.

A shader file may contain ``#include "lib/name.glsl"`` lines, relative to ``gpu_shaders/``. Included
text appears once, at its first mention.
"""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ..errors import ShaderCompileError

SHADER_ROOT = Path(__file__).resolve().parents[2] / "gpu_shaders"

# For each joined text, the sources of its lines; as many texts as there are shaders.
_places = {}

_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')


# Memo of the path alone: shaders come with Aplanat.
@cache
def load(path):
    """Return the text of a shader file with its includes in place.

    Parameters
    ----------
    path : str
        Relative to ``gpu_shaders/``.

    Returns
    -------
    str

    Raises
    ------
    ShaderCompileError
        If the file or one of its includes is missing.
    """
    return _remember(located_lines(path))


@dataclass(frozen=True)
class Text:
    """Generated text among shader files."""

    text: str


def join(parts):
    """Return shader files and generated text as one, every included file once.

    Parameters
    ----------
    parts : iterable of str or Text
        Paths relative to ``gpu_shaders/``, or text as it is.

    Returns
    -------
    str
    """
    return _join(SHADER_ROOT, tuple(parts))


# As many as there are shapes of node trees; a scene asks for each of them once a surface.
@cache
def _join(_root, parts):
    return _remember(located_parts(parts))


def locate(text, number):
    """Return the source of a line of a text made by `load` or `join`.

    Parameters
    ----------
    text : str
    number : int
        From 1.

    Returns
    -------
    str
        ``path:line``; ``line N`` of texts that were made elsewhere.
    """
    places = _places.get(text, ())
    if 1 <= number <= len(places):
        path, line = places[number - 1]
        return f"{path}:{line}"
    return f"line {number}"


def _remember(lines):
    text = "\n".join(line for line, _, _ in lines) + "\n"
    _places[text] = tuple((path, number) for _, path, number in lines)
    return text


def located_parts(parts):
    """Return the lines of `join` with the file and line number that each came from."""
    seen, lines = set(), []
    for part in parts:
        if isinstance(part, Text):
            numbered = enumerate(part.text.splitlines(), start=1)
            lines += [(line, "generated", number) for number, line in numbered]
        elif part not in seen:
            lines += _expand(part, seen)
    return lines


def located_lines(path):
    """Return the lines of `load` with the file and line number that each came from."""
    return _expand(path, set())


# Memo of its arguments alone: shaders come with Aplanat.
@cache
def _read(root, path):
    """Return the lines of a file, each with the path that it includes or None."""
    file = root / path
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise ShaderCompileError(path, f"{file}: {error.strerror}") from error
    matches = [(line, _INCLUDE.match(line)) for line in text.splitlines()]
    return [(line, match and match.group(1)) for line, match in matches]


def _expand(path, seen):
    seen.add(path)
    lines = []
    for number, (line, included) in enumerate(_read(SHADER_ROOT, path), start=1):
        if included is None:
            lines.append((line, path, number))
        elif included not in seen:
            lines.extend(_expand(included, seen))
    return lines
