"""Zoom positions of Zemax files: configurations of which distances, aperture and field change.

``MNUM n k`` tells their number; ``THIC surface position value`` a distance, ``APER`` and ``YFIE``
likewise the aperture and the height of a field point.
"""

import math

from ..draft.draft import DraftPosition
from ..draft.source_text import excerpt, whole_number
from .zemax_rows import distance, field, object_distance, opening

# What a lens file may have.
_MOST_POSITIONS = 50
READ_WORDS = {"MNUM", "MOFF", "THIC", "YFIE", "XFIE", "APER"}
# Operands that change what zoom positions of a lens file share.
_UNREADABLE_WORDS = """
    AFOC APDT APDX APDY APMN APMX CADX CADY CATX CATY CATZ CBDX CBDY CBTX CBTY CBTZ CONN COTN
    CRVT EDVA GLSS GPEX GPIU IGNM IGNR MABB MDPG MIND NGLS NPAR NPOS NPRO PAR1 PAR2 PAR3 PAR4
    PAR5 PAR6 PAR7 PAR8 PRAM PRES SATP SDIA STPS TELE TEMP XDVA
"""
_UNREADABLE = set(_UNREADABLE_WORDS.split())


def read_positions(header, wavelength):
    """Read the configurations into the draft of the lens.

    Only those with the object at infinity are zoom positions; others show how the lens focuses.

    Parameters
    ----------
    header : Header
    wavelength : float
        nm, of the aperture.
    """
    draft = header.draft
    count = header.count("MNUM") or 1
    if count <= 1:
        return
    start = header.last("MNUM")[0]
    if count > _MOST_POSITIONS:
        draft.refusals.add(
            "E09", start, f"{count} zoom positions; a lens may have {_MOST_POSITIONS}"
        )
        return
    for keyword in sorted(_UNREADABLE & set(header.rows)):
        for line, _, text in header.rows[keyword]:
            if line > start:
                draft.refusals.add(
                    "I04", line, f"{excerpt(text)}: this cannot change between zoom positions"
                )
    operands = [_operands(header, start, position, count) for position in range(1, count + 1)]
    if draft.refusals:
        return
    read = [_read_position(header, rows, wavelength) for rows in operands]
    far = [position for position, away in read if math.isinf(away)]
    if far and len(far) < count:
        draft.passed_over.add(f"{count - len(far)} configurations with a near object", start)
    draft.object_distance = math.inf if far else read[0][1]
    draft.positions = far or [position for position, _ in read]


def _operands(header, start, position, count):
    # The rows of one configuration; a malformed row is refused once, at the first.
    rows = []
    for keyword in ("THIC", "XFIE", "YFIE", "APER"):
        for row in header.rows.get(keyword, []):
            line, words, text = row
            if line < start:
                continue
            numbers = [whole_number(word) for word in words[1:3]]
            well_formed = len(words) > 3 and None not in numbers
            if position == 1 and not (well_formed and 1 <= numbers[1] <= count):
                header.draft.refusals.add(
                    "I07", line, f"{excerpt(text)} is not {keyword}, surface, position, value"
                )
            elif well_formed and numbers[1] == position:
                rows.append((line, [keyword, *words[1:]], text))
    return rows


def _read_position(header, rows, wavelength):
    draft = header.draft
    thicknesses = [surface.thickness for surface in draft.surfaces]
    away = draft.object_distance
    aperture = None
    for row in rows:
        line, words, text = row
        if words[0] == "APER":
            aperture = row
        if words[0] != "THIC":
            continue
        surface = whole_number(words[1])
        if surface == 0:
            away = object_distance(row, header, 3)
        elif 1 <= surface <= len(thicknesses):
            thicknesses[surface - 1] = distance(row, header, 3)
            if math.isinf(thicknesses[surface - 1]):
                draft.refusals.add("I07", line, f"{excerpt(text)}: only an object is at infinity")
        else:
            draft.refusals.add("I07", line, f"{excerpt(text)}: the lens has no such surface")
    points = [row for row in rows if row[1][0] in ("XFIE", "YFIE")]
    position = DraftPosition(
        thicknesses, opening(header, wavelength, aperture), field(header, points)
    )
    return position, away
