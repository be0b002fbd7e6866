"""Typed reading of the tables of a lens file, with every fault noted.

A value that is missing or wrong is noted in the findings and read as None, so that the rest of the
file can still be checked.
"""

import json
import math
import re
from dataclasses import dataclass, field
from itertools import islice

from ...errors import LensFileError
from .findings import Finding

# With so many errors a file is not a lens with mistakes but something else.
MOST_ERRORS = 1000
# Characters of a text from the file that a message repeats.
SHOWN_LENGTH = 40


# Known texts that an unknown one is compared with.
MOST_COMPARED = 100


@dataclass
class Findings:
    """Errors and warnings of one file, in the order in which they were found.

    Parameters
    ----------
    file_name : str
    errors, warnings : list of Finding
    """

    file_name: str
    errors: list[Finding] = field(default_factory=list)
    warnings: list[Finding] = field(default_factory=list)

    def add(self, code, path, message):
        """Note an error, or a warning if the code starts with W.

        Raises
        ------
        LensFileError
            If there are so many errors that reading on is of no use.
        """
        kept = self.warnings if code.startswith("W") else self.errors
        kept.append(Finding(code, path, message))
        if len(self.errors) >= MOST_ERRORS:
            self.errors[-1] = Finding(
                code,
                path,
                f"{message}; after {MOST_ERRORS} errors the rest of the file was not checked",
            )
            self.refuse()

    def refuse(self):
        """Raise a LensFileError with everything that was found."""
        raise LensFileError(self.file_name, self.errors, self.warnings)


@dataclass(frozen=True)
class Range:
    """The range of numbers that a key allows.

    Parameters
    ----------
    low, high : float
    above, below : bool
        Whether the bound itself is left out.
    """

    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    below: bool = False

    def __contains__(self, value):
        """Whether a number is allowed."""
        if value < self.low or (self.above and value == self.low):
            return False
        return not (value > self.high or (self.below and value == self.high))

    def __str__(self):
        """Return the range in words."""
        if self.high == math.inf:
            return f"greater than {self.low:g}" if self.above else f"{self.low:g} or more"
        low = f"greater than {self.low:g}" if self.above else f"at least {self.low:g}"
        return f"{low} and {'less than' if self.below else 'at most'} {self.high:g}"


class Table:
    """One table of a lens file.

    Parameters
    ----------
    values : dict
    path : str
        Of the table; empty for the document.
    findings : Findings
    keys : sequence of str, optional
        The keys it may have. Others are noted (E05).
    """

    def __init__(self, values, path, findings, keys=None):
        self.values = values
        self.path = path
        self.findings = findings
        if keys is not None:
            self.check_keys(keys)

    def __contains__(self, key):
        """Whether the table has a key."""
        return key in self.values

    def at(self, key):
        """Return the path of a key, as findings name it."""
        return key_path(self.path, key)

    def add(self, code, key, message):
        """Note a finding at a key of this table."""
        self.findings.add(code, self.at(key), message)

    def check_keys(self, keys):
        """Note keys that are not among the known ones (E05)."""
        for key in self.values:
            if key not in keys:
                self.add("E05", key, f"the key {show(key)} is not known{self.hint(key, keys)}")

    def hint(self, text, known):
        """Return the end of a message that suggests the known text nearest to another."""
        near = nearest(text, known)
        return f"; did you mean {show(near)}?" if near else ""

    def require(self, key):
        """Return whether a key is there; a missing one is an error (E06)."""
        if key not in self.values:
            self.add("E06", key, f"the required key {show(key)} is missing")
        return key in self.values

    def wrong_type(self, key, wanted):
        """Note that the value of a key is of another type than wanted (E07)."""
        self.add("E07", key, _wrong_type(self.values[key], wanted))

    def number(self, key, allowed=None, default=None, infinite=False):
        """Return a number.

        Parameters
        ----------
        key : str
        allowed : Range, optional
        default : float or None
            For a missing key.
        infinite : bool
            Whether inf is allowed.

        Returns
        -------
        float or None
            None if it is missing without a default, or wrong.
        """
        if key not in self.values:
            return default
        return checked_number(self.values[key], self.at(key), self.findings, allowed, infinite)

    def integer(self, key, allowed=None, default=None):
        """Return a whole number; see `number`."""
        value = self._typed(key, int, "an integer", default)
        if value is None or value is default or allowed is None or value in allowed:
            return value
        self.add("E09", key, f"{show(value)} must be {allowed}")
        return None

    def text(self, key, default=None):
        """Return a text; see `number`."""
        return self._typed(key, str, "text", default)

    def choice(self, key, allowed, default=None):
        """Return one text of a list (E10); see `number`."""
        value = self.text(key, default)
        if value is None or value == default or value in allowed:
            return value
        listed = " or ".join(f'"{one}"' for one in allowed)
        self.add("E10", key, f"{show(value)} must be {listed}")
        return None

    def boolean(self, key, default=None):
        """Return true or false; see `number`."""
        return self._typed(key, bool, "true or false", default)

    def table(self, key, keys=None):
        """Return a table inside this one, or None if it is missing or wrong."""
        value = self._typed(key, dict, "a table", None)
        return None if value is None else Table(value, self.at(key), self.findings, keys)

    def tables(self, key):
        """Return an array of tables, or None if it is missing or wrong.

        Parameters
        ----------
        key : str

        Returns
        -------
        list of (dict or None), or None
            None in it for an item that is no table.
        """
        listed = self._typed(key, list, "an array of tables", None)
        if listed is None:
            return None
        rows = []
        for number, row in enumerate(listed, 1):
            if not isinstance(row, dict):
                self.findings.add("E07", f"{self.at(key)}[{number}]", _wrong_type(row, "a table"))
            rows.append(row if isinstance(row, dict) else None)
        return rows

    def _typed(self, key, kind, wanted, default):
        if key not in self.values:
            return default
        value = self.values[key]
        # A boolean is an int in Python, but not in a lens file.
        if isinstance(value, kind) and isinstance(value, bool) == (kind is bool):
            return value
        self.wrong_type(key, wanted)
        return None


def checked_number(value, path, findings, allowed=None, infinite=False):
    """Return a value as float, or None with a finding if it is not an allowed number.

    Parameters
    ----------
    value : object
        As the TOML parser gave it.
    path : str
    findings : Findings
    allowed : Range, optional
    infinite : bool
        Whether inf is allowed.

    Returns
    -------
    float or None
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        findings.add("E07", path, _wrong_type(value, "a number"))
        return None
    key = path.rpartition(".")[2]
    try:
        number = float(value)
    except OverflowError:
        findings.add("E08", path, f"{key} is {show(value)}; it must be a finite number")
        return None
    if math.isnan(number) or (math.isinf(number) and not infinite):
        wanted = "a number or inf" if infinite else "a finite number"
        findings.add("E08", path, f"{key} is {number}; it must be {wanted}")
        return None
    if allowed is not None and number not in allowed:
        findings.add("E09", path, f"{number!r} must be {allowed}")
        return None
    return number


def key_path(path, key):
    """Join the path of a table and a key; a key that is not bare stands in quotes."""
    name = key if re.fullmatch(r"[A-Za-z0-9_-]{1,80}", key) else show(key)
    return f"{path}.{name}" if path else name


def show(value):
    """Write a value of the file for a message: short, in one line, printable."""
    if isinstance(value, str):
        text = value if len(value) <= SHOWN_LENGTH else value[: SHOWN_LENGTH - 3] + "..."
        quoted = json.dumps(text, ensure_ascii=False)
        return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in quoted)
    if isinstance(value, int) and value.bit_length() > 64:
        return f"an integer of {value.bit_length()} bits"
    return json.dumps(value) if isinstance(value, bool) else repr(value)


def nearest(text, known):
    """Return the known text nearest to a given one, or None if none is close."""
    from difflib import get_close_matches

    if len(text) > 2 * SHOWN_LENGTH:
        return None
    compared = islice(known, MOST_COMPARED)
    return next(iter(get_close_matches(text, compared, 1, 0.6)), None)


def _wrong_type(value, wanted):
    if isinstance(value, bool):
        found = f"the boolean {show(value)}"
    elif isinstance(value, int):
        found = f"the integer {show(value)}"
    elif isinstance(value, float):
        found = f"the float {value!r}"
    elif isinstance(value, str):
        found = f"the text {show(value)}"
    elif isinstance(value, dict):
        found = "a table"
    elif isinstance(value, list):
        found = "an array"
    else:
        found = "a date or time"
    return f"found {found}, wanted {wanted}"
