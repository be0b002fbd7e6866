"""Rows of Zemax files: numbers with their unit, the aperture and the fields."""

import math
from dataclasses import dataclass

from ....optics.glass import REFERENCE_WAVELENGTH_NM
from ..draft.draft import Draft, Field, Opening
from ..draft.source_text import excerpt, number, whole_number

# The program itself writes METER; M and IN are those of its documentation and of other writers.
UNITS_MM = {"MM": 1.0, "CM": 10.0, "M": 1000.0, "IN": 25.4, "METER": 1000.0}
APERTURES = {
    "ENPD": "entrance pupil",
    "FNUM": "f-number",
    "FLOA": "stop",
    "OBNA": "object NA",
}
# What the aperture is where the second number of its row is 1.
_FLAGGED_APERTURES = {"FNUM": "working f-number", "OBNA": "object cone angle"}
# Farther than this, in the file's unit, an object is at infinity: programs write 1e10.
_FARTHEST = 1.0e9
_FIELD_KINDS = {0: "angle", 1: "object height", 2: "image height", 3: "real image height"}


@dataclass
class Header:
    """The lines outside the surface blocks.

    Parameters
    ----------
    rows : dict of str to list of (int, list of str, str)
        Line number, words and text, by keyword.
    draft : Draft
        Where findings go.
    scale : float
        mm per unit of the file.
    """

    rows: dict
    draft: Draft
    scale: float = 1.0

    def last(self, keyword):
        """Return the last row of a keyword, or None."""
        rows = self.rows.get(keyword)
        return rows[-1] if rows else None

    def word(self, keyword, position=1):
        """Return a word of the last row of a keyword, or None."""
        row = self.last(keyword)
        return row[1][position] if row and len(row[1]) > position else None

    def words(self, keyword):
        """Return the words behind the last row's keyword."""
        row = self.last(keyword)
        return tuple(row[1][1:]) if row else ()

    def count(self, keyword, position=1):
        """Return a whole number of the last row of a keyword, or None."""
        word = self.word(keyword, position)
        return None if word is None else whole_number(word)


def value(row, position, draft):
    """Return a number of a row; I07 and 0 if there is none.

    Parameters
    ----------
    row : (int, list of str, str)
    position : int
        0 is the keyword.
    draft : Draft

    Returns
    -------
    float
    """
    line, words, text = row
    found = number(words[position]) if position < len(words) else None
    if found is None:
        draft.refusals.add("I07", line, f"{excerpt(text)} has no number {position}")
        return 0.0
    return found


def distance(row, header, position=1):
    """Return a distance in mm, inf for INFINITY.

    Parameters
    ----------
    row : (int, list of str, str)
    header : Header
    position : int

    Returns
    -------
    float
    """
    words = row[1]
    if len(words) > position and words[position].upper() == "INFINITY":
        return math.inf
    return value(row, position, header.draft) * header.scale


def object_distance(row, header, position=1):
    """Return the distance of the object in mm, inf if it is far away.

    Parameters
    ----------
    row : (int, list of str, str)
    header : Header
    position : int

    Returns
    -------
    float
    """
    found = distance(row, header, position)
    return math.inf if found >= _FARTHEST * header.scale else found


def primary_wavelength(header):
    """Return the wavelength in nm for which the aperture is meant.

    Parameters
    ----------
    header : Header

    Returns
    -------
    float
    """
    wanted = header.count("PWAV") or 1
    for row in header.rows.get("WAVM", []):
        if len(row[1]) > 2 and whole_number(row[1][1]) == wanted:
            return value(row, 2, header.draft) * 1000.0
    return REFERENCE_WAVELENGTH_NM


def opening(header, wavelength, override=None):
    """Return the aperture of a file, or None if it has none.

    Parameters
    ----------
    header : Header
    wavelength : float
        nm.
    override : (int, list of str, str) or None
        A row of a zoom position; its fourth word stands for the number of the header.

    Returns
    -------
    Opening or None
    """
    for keyword, kind in APERTURES.items():
        row = header.last(keyword)
        if row is None:
            continue
        if kind == "stop":
            return Opening(kind, 0.0, wavelength)
        if header.count(keyword, 2) == 1:
            kind = _FLAGGED_APERTURES.get(keyword, kind)
        row, position = (row, 1) if override is None else (override, 3)
        found = value(row, position, header.draft)
        if found <= 0.0:
            header.draft.refusals.add("I07", row[0], f"{excerpt(row[2])} must be above 0")
        scale = header.scale if kind == "entrance pupil" else 1.0
        return Opening(kind, found * scale, wavelength)
    return None


def field(header, overrides=()):
    """Return the field of a file, or None if all its points are on the axis.

    Parameters
    ----------
    header : Header
    overrides : sequence of (int, list of str, str)
        Rows ``XFIE`` and ``YFIE`` of a zoom position: keyword, point, position, value.

    Returns
    -------
    Field or None
    """
    code = header.count("FTYP")
    row = header.last("FTYP")
    kind = _FIELD_KINDS.get(0 if row is None else code)
    if kind is None:
        header.draft.refusals.add("I07", row[0], f"{excerpt(row[2])}: field types are 0 to 3")
        return None
    points = {}
    for axis, keyword in enumerate(("XFLN", "YFLN")):
        found = header.last(keyword)
        count = header.count("FTYP", 3) or (len(found[1]) - 1 if found else 0)
        for index in range(1, 1 + min(count, len(found[1]) - 1 if found else 0)):
            points.setdefault(index, [0.0, 0.0])[axis] = value(found, index, header.draft)
    for found in overrides:
        index = whole_number(found[1][1])
        axis = 0 if found[1][0] == "XFIE" else 1
        if index in points:
            points[index][axis] = value(found, 3, header.draft)
    scale = 1.0 if kind == "angle" else header.scale
    values = sorted({math.hypot(*point) * scale for point in points.values()} - {0.0})
    return Field(kind, tuple(values)) if values else None
