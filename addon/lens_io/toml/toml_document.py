"""Parsing of a lens file: bytes to the values of a TOML 1.0 document.

What a lens file needs is small and flat. Documents built to exhaust the parser (arrays in arrays
without end, keys of thousands of parts, numbers of thousands of digits) are refused before or by
it, so that reading takes time in proportion to the size of the file.
"""

import re
import stat
import sys
import tomllib
from pathlib import Path

# The largest file that is read, in bytes.
LARGEST_FILE = 1 << 20
# A lens file needs 3 levels; tomllib takes three stack frames for one.
DEEPEST_NESTING = 40
# A lens file needs 3 parts; tomllib's time grows with the square of the parts.
MOST_KEY_PARTS = 20

# A string that is not closed goes on to the end: the parser will say so, this scan need not.
_BASIC = r'"(?:[^"\\\n]|\\.)*+"?+'
_LITERAL = r"'[^'\n]*+'?+"
_PART = rf"(?:[A-Za-z0-9_+-]++|{_BASIC}|{_LITERAL})"
_TOKEN = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*+(?:"{3,5})?+'
    r"|'''(?:[^']|'(?!''))*+(?:'{3,5})?+"
    r"|#[^\n]*+"
    rf"|(?P<key>{_PART}(?:[ \t]*+\.[ \t]*+{_PART})*+)"
    r"|(?P<open>[\[{])"
    r"|(?P<close>[\]}])",
    re.DOTALL,
)


def read_bytes(path):
    """Read a lens file.

    Parameters
    ----------
    path : Path or str

    Returns
    -------
    bytes or None
        At most one byte more than `LARGEST_FILE`; None if the file cannot be read.
    str
        The reason if it cannot be read, else empty.
    """
    try:
        path = Path(path)
        if path.exists() and not stat.S_ISREG(path.stat().st_mode):
            return None, "it is a folder" if path.is_dir() else "it is not a regular file"
        with path.open("rb") as file:
            return file.read(LARGEST_FILE + 1), ""
    except OSError as error:
        return None, (error.strerror or str(error)).lower()
    except ValueError:
        return None, "its name holds a character that no file name can have"


def decode(content):
    """Decode a lens file; a byte-order mark in front is left out.

    Parameters
    ----------
    content : bytes

    Returns
    -------
    str or None
        None if the content is no lens file (code E01).
    str
        The reason, else empty.
    """
    if len(content) > LARGEST_FILE:
        return None, f"the file is larger than {LARGEST_FILE} bytes (1 MiB)"
    try:
        return content.decode("utf-8-sig"), ""
    except UnicodeDecodeError as error:
        return None, (
            f"the file is not UTF-8: byte {content[error.start]:#04x} "
            f"at offset {error.start} ({error.reason})"
        )


def parse(text):
    """Parse a TOML document.

    Parameters
    ----------
    text : str

    Returns
    -------
    dict or None
        None if it is not TOML, or more deeply nested than any lens file (code E02).
    str
        The reason with line and column, else empty.
    """
    # As TOML has it; tomllib counts its lines and columns after the same step.
    text = text.replace("\r\n", "\n")
    reason = _beyond_limits(text)
    if reason:
        return None, reason
    try:
        return tomllib.loads(text), ""
    except tomllib.TOMLDecodeError as error:
        return None, str(error).replace("(at end of document)", f"({_place(text, len(text))})")
    except RecursionError:
        return None, f"nested too deeply ({_place(text, len(text))})"
    except ValueError:
        # The one that tomllib lets through: int() refuses to convert so many decimal digits.
        return None, f"a number has too many digits ({_place(text, _long_number(text))})"


def _beyond_limits(text):
    depth = 0
    for token in _TOKEN.finditer(text):
        kind = token.lastgroup
        if kind == "open":
            depth += 1
            if depth > DEEPEST_NESTING:
                return (
                    f"arrays or tables are nested more than {DEEPEST_NESTING} deep "
                    f"({_place(text, token.start())})"
                )
        elif kind == "close":
            depth = max(0, depth - 1)
        elif kind == "key" and token.group().count(".") >= MOST_KEY_PARTS:
            parts = re.findall(_PART, token.group())
            if len(parts) > MOST_KEY_PARTS:
                return (
                    f"a key has {len(parts)} parts, more than {MOST_KEY_PARTS} "
                    f"({_place(text, token.start())})"
                )
    return ""


def _long_number(text):
    digits = sys.get_int_max_str_digits()
    for token in _TOKEN.finditer(text):
        if len(token.group()) > digits and re.fullmatch(r"[+-]?[\d_]+", token.group()):
            return token.start()
    return 0


def _place(text, position):
    line = text.count("\n", 0, position) + 1
    column = position - text.rfind("\n", 0, position)
    return f"at line {line}, column {column}"
