"""Text of foreign lens files: bytes to numbered lines, words to numbers.

Files of lens programs are UTF-16 with a byte-order mark, UTF-8, or 8-bit text (Latin-1). Numbers
are plain ASCII decimals; nan, infinities and numbers beyond the range of a double are refused.
"""

import codecs
import math
import re

from ...toml.findings import Finding
from ...toml.toml_document import LARGEST_FILE, read_bytes

_NUMBER = re.compile(r"[+-]?(?:\d{1,400}\.?\d{0,400}|\.\d{1,400})(?:[eEdD][+-]?\d{1,6})?", re.ASCII)
_LINE_END = re.compile(r"\r\n|\r|\n")
# Digits of a radius that was stored as a curvature, and what storing it may have changed, as a
# share: a curvature has 16 to 17 digits.
_RADIUS_DIGITS = 12
_CURVATURE_ROUNDING = 1.0e-14
# The longest file of a lens program has some ten thousand lines.
MOST_LINES = 50_000
# How much of a line a message repeats, in characters.
_EXCERPT = 60
# A file with more errors than this is of another kind; the rest would not help.
_MOST_FINDINGS = 50
# Line numbers that a report names for one keyword.
_MOST_LINES = 6


def read_source(path):
    """Read the bytes of a lens file.

    Parameters
    ----------
    path : Path or str

    Returns
    -------
    bytes or None
    Finding or None
        E01 if it cannot be read or is too large.
    """
    content, reason = read_bytes(path)
    if content is None:
        return None, Finding("E01", "", f"the file cannot be read: {reason}")
    return content, size_finding(content)


def size_finding(content):
    """Return an E01 if a file is larger than a lens file may be, else None."""
    if len(content) <= LARGEST_FILE:
        return None
    return Finding("E01", "", f"the file is larger than {LARGEST_FILE} bytes (1 MiB)")


def decode(content):
    """Return the text of a file, or None if its bytes are no text.

    Parameters
    ----------
    content : bytes

    Returns
    -------
    str or None
    """
    marks = {codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
    try:
        if content[:2] in marks:
            text = content[2:].decode(marks[content[:2]])
        elif content.startswith(codecs.BOM_UTF8):
            text = content[3:].decode("utf-8")
        else:
            text = _decode_unmarked(content)
    except UnicodeDecodeError:
        return None
    return None if "\0" in text else text


def _decode_unmarked(content):
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def numbered_lines(text):
    """Return the lines of a text with their numbers, from 1.

    Parameters
    ----------
    text : str

    Returns
    -------
    list of (int, str)
    """
    # Some old programs close a file with the end-of-file character of CP/M.
    return list(enumerate(_LINE_END.split(text.rstrip("\x1a")), 1))


def number(word):
    """Return a decimal number, or None if the word is none that a double can hold.

    Parameters
    ----------
    word : str
        Exponents may be marked by E or, as in Fortran, by D.

    Returns
    -------
    float or None
    """
    if not _NUMBER.fullmatch(word):
        return None
    value = float(word.upper().replace("D", "E"))
    return value if math.isfinite(value) else None


def whole_number(word):
    """Return an integer of up to nine digits, or None.

    Parameters
    ----------
    word : str

    Returns
    -------
    int or None
    """
    return int(word) if re.fullmatch(r"[+-]?\d{1,9}", word, re.ASCII) else None


def radius_of(curvature, scale):
    """Return the radius of a curvature.

    Programs store curvatures of radii with few digits; those digits come back.

    Parameters
    ----------
    curvature : float
        1 over the unit of the file.
    scale : float
        mm per unit.

    Returns
    -------
    float
        mm; inf for a plane.
    """
    if curvature == 0.0 or math.isinf(1.0 / curvature):
        return math.inf
    exact = 1.0 / curvature
    short = float(f"{exact:.{_RADIUS_DIGITS}g}")
    near = abs(short - exact) <= _CURVATURE_ROUNDING * abs(exact)
    return (short if near else exact) * scale


def clean(text):
    """Return a text without characters that do not print and without outer blanks.

    Parameters
    ----------
    text : str

    Returns
    -------
    str
    """
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def excerpt(text):
    """Return the start of a line as a message shows it.

    Parameters
    ----------
    text : str

    Returns
    -------
    str
    """
    shown = clean(text[: 4 * _EXCERPT])
    return f"'{shown[:_EXCERPT]}{'...' if len(shown) > _EXCERPT else ''}'"


class Refusals:
    """Collects why a file is not read."""

    def __init__(self):
        self._findings = []
        self._more = 0

    def add(self, code, line, message):
        """Add a finding.

        Parameters
        ----------
        code : str
        line : int or None
            None: the whole file is meant.
        message : str
        """
        if len(self._findings) < _MOST_FINDINGS:
            self._findings.append(Finding(code, f"line {line}" if line else "", message))
        else:
            self._more += 1

    def __bool__(self):
        """Whether there is any."""
        return bool(self._findings)

    def has(self, code):
        """Whether a code is among them."""
        return any(finding.code == code for finding in self._findings)

    def findings(self):
        """Return the findings.

        Returns
        -------
        tuple of Finding
        """
        if not self._more:
            return tuple(self._findings)
        last = self._findings[-1]
        message = f"{last.message} (and {self._more} more findings)"
        return (*self._findings[:-1], Finding(last.code, last.path, message))


class PassedOver:
    """Collects the parts of a file that a lens description cannot hold, by keyword."""

    def __init__(self):
        self._lines = {}

    def add(self, what, line):
        """Add one thing that the lens-description has no room for.

        Parameters
        ----------
        what : str
        line : int
        """
        self._lines.setdefault(what, []).append(line)

    def report(self):
        """Return one sentence per keyword, in the order of the file.

        Returns
        -------
        tuple of str
        """
        return tuple(f"{what} ({_line_list(lines)})" for what, lines in self._lines.items())


def _line_list(lines):
    if len(lines) == 1:
        return f"line {lines[0]}"
    named = ", ".join(str(line) for line in lines[:_MOST_LINES])
    more = len(lines) - _MOST_LINES
    return f"lines {named}" + (f" and {more} more" if more > 0 else "")
