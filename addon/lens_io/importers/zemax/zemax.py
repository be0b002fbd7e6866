"""Importer of sequential Zemax files (``.zmx``).

A header of keywords, then ``SURF i`` blocks; surface 0 is the object, the last one the image.
"""

import math

from ....optics.glass import AIR, AbbeGlass, ConstantGlass
from ..draft.draft import Draft, DraftSurface
from ..draft.media import UnknownGlassError, named_glass
from ..draft.source_text import clean, excerpt, number, radius_of, whole_number
from .zemax_rows import (
    APERTURES,
    UNITS_MM,
    Header,
    distance,
    field,
    object_distance,
    opening,
    primary_wavelength,
    value,
)
from .zemax_zoom import READ_WORDS, read_positions

FORMAT_NAME = "Zemax file"
# A surface has this many parameters of an even asphere: a_2 to a_16.
_ASPHERE_PARAMETERS = 8
# Rims that are no circle round the axis.
_OTHER_RIMS = {"SQAP", "ELAP", "SPID", "OBSC", "EOBS", "SQOB", "UDAP", "UDOB"}
# What describes a surface, and may stand there once.
_SURFACE_WORDS = {"TYPE", "CURV", "DISZ", "CONI", "DIAM", "GLAS", "CLAP", "STOP"}
_READ_WORDS = {"MODE", "UNIT", "NAME", "NOTE", "WAVM", "PWAV", "FTYP", "GCAT", "XFLN", "YFLN"}


def looks_like(lines):
    """Return whether there are SURF blocks as Zemax writes them.

    Parameters
    ----------
    lines : list of (int, str)

    Returns
    -------
    bool
    """
    firsts = {text.split(None, 1)[0] for _, text in lines if text.strip()}
    return "SURF" in firsts and bool(firsts & {"MODE", "UNIT", "VERS", "WAVM", "CURV", "DISZ"})


def read(lines, options):
    """Read a file.

    Parameters
    ----------
    lines : list of (int, str)
    options : ImportOptions

    Returns
    -------
    Draft
    """
    draft = Draft()
    header_rows, blocks = _split(lines, draft)
    header = Header(header_rows, draft)
    _check_mode(header)
    header.scale = _unit(header)
    if len(blocks) < 3:
        draft.refusals.add(
            "I07", None, f"the file has {len(blocks)} surfaces; object, lens and image are needed"
        )
        return draft
    _read_object(*blocks[0], header)
    for index, (line, rows) in enumerate(blocks[1:-1], 1):
        draft.surfaces.append(_read_surface(line, rows, index, header, options))
    _read_image(blocks[-1][1], header)
    _name(header)
    wavelength = primary_wavelength(header)
    draft.opening = opening(header, wavelength)
    draft.field = field(header)
    read_positions(header, wavelength)
    _pass_over_header(header)
    if not any(surface.rim_is_fixed for surface in draft.surfaces):
        draft.notes.append("Semi-diameters are the automatic ones of the file.")
    draft.choose_stop(options)
    draft.drop_dummies()
    return draft


def _split(lines, draft):
    header, blocks = {}, []
    inside = False
    for line, text in lines:
        words = text.split()
        if not words:
            continue
        keyword = words[0].upper()
        if keyword == "SURF":
            if draft.is_full(len(blocks), line):
                break
            inside = True
            if len(words) < 2 or whole_number(words[1]) != len(blocks):
                draft.refusals.add(
                    "I07", line, f"{excerpt(text)}: surface {len(blocks)} was to come next"
                )
            blocks.append((line, []))
        elif inside and (text[:1].isspace() or keyword in _SURFACE_WORDS):
            blocks[-1][1].append((line, [keyword, *words[1:]], text))
        elif keyword in _SURFACE_WORDS:
            draft.refusals.add("I07", line, f"{excerpt(text)} stands in no surface")
        else:
            inside = False
            header.setdefault(keyword, []).append((line, words, text))
    return header, blocks


def _check_mode(header):
    row = header.last("MODE")
    found = (header.word("MODE") or "none").upper()
    if found != "SEQ":
        header.draft.refusals.add(
            "I04", row and row[0], f"mode {excerpt(found)} is not supported; it must be SEQ"
        )


def _unit(header):
    row = header.last("UNIT")
    found = (header.word("UNIT") or "none").upper()
    if found not in UNITS_MM:
        known = ", ".join(UNITS_MM)
        header.draft.refusals.add(
            "I08", row and row[0], f"unit {excerpt(found)} is not known; known are {known}"
        )
    return UNITS_MM.get(found, 1.0)


def _read_object(block_line, rows, header):
    draft = header.draft
    _check_block(block_line, rows, ("DISZ",), draft)
    for row in rows:
        line, words, text = row
        if words[0] == "DISZ":
            draft.object_distance = object_distance(row, header)
        elif words[0] == "GLAS":
            draft.refusals.add("I04", line, f"{excerpt(text)}: the object must be in air")
        elif words[0] == "STOP":
            draft.refusals.add("I04", line, "the stop is the object; it must be a lens surface")
        elif words[0] == "TYPE":
            _check_type(row, draft)


def _check_block(line, rows, needed, draft):
    found = [words[0] for _, words, _ in rows]
    for keyword in needed:
        if keyword not in found:
            draft.refusals.add("I07", line, f"the surface has no {keyword}")
    for keyword in sorted(_SURFACE_WORDS):
        if found.count(keyword) > 1:
            draft.refusals.add("I07", line, f"the surface has {keyword} more than once")


def _read_image(rows, header):
    for row in rows:
        line, words, text = row
        if words[0] == "TYPE":
            _check_type(row, header.draft)
        elif words[0] == "CURV" and value(row, 1, header.draft) != 0.0:
            header.draft.passed_over.add("curved image surface: pictures are flat", line)
        elif words[0] == "STOP":
            header.draft.refusals.add("I04", line, "the stop is the image surface")
        elif words[0] == "GLAS" and len(words) > 1 and words[1].upper() == "MIRROR":
            header.draft.refusals.add("I02", line, f"{excerpt(text)} is a mirror")


def _check_type(row, draft):
    line, words, _ = row
    kind = words[1].upper() if len(words) > 1 else "none"
    if kind == "COORDBRK":
        draft.refusals.add("I03", line, "a coordinate break; lenses here have one common axis")
    elif kind not in ("STANDARD", "EVENASPH"):
        draft.refusals.add(
            "I04", line, f"surface type {excerpt(kind)} is not supported; STANDARD, EVENASPH are"
        )
    return kind


def _read_surface(line, rows, index, header, options):
    draft, scale = header.draft, header.scale
    surface = DraftSurface(line, index)
    _check_block(line, rows, ("CURV", "DISZ"), draft)
    kind, parameters, clear = "STANDARD", {}, None
    for row in rows:
        line, words, text = row
        keyword = words[0]
        if keyword == "TYPE":
            kind = _check_type(row, draft)
        elif keyword == "STOP":
            surface.is_stop = True
        elif keyword == "CURV":
            curvature = value(row, 1, draft)
            surface.radius = radius_of(curvature, scale)
        elif keyword == "DISZ":
            surface.thickness = distance(row, header)
            if math.isinf(surface.thickness):
                draft.refusals.add("I07", line, f"{excerpt(text)}: only an object is at infinity")
        elif keyword == "CONI":
            surface.conic = value(row, 1, draft)
        elif keyword == "PARM":
            _read_parameter(row, parameters, draft)
        elif keyword == "DIAM":
            radius = value(row, 1, draft) * scale
            surface.semi_diameter = radius if radius != 0.0 else None
            surface.rim_is_fixed = len(words) > 2 and words[2] == "1"
        elif keyword == "CLAP":
            clear = _clear_radius(row, header)
        elif keyword == "GLAS":
            surface.glass = _glass(row, header, options)
        else:
            _read_other(row, draft)
    if clear is not None:
        surface.semi_diameter, surface.rim_is_fixed = clear, True
    _apply_parameters(surface, kind, parameters, header)
    return surface


def _read_parameter(row, parameters, draft):
    line, words, text = row
    order = whole_number(words[1]) if len(words) > 1 else None
    if order is None or order < 0:
        draft.refusals.add("I07", line, f"{excerpt(text)} is not PARM, a number, and a value")
        return
    parameters[order] = (value(row, 2, draft), line)


def _apply_parameters(surface, kind, parameters, header):
    for order, (coefficient, line) in parameters.items():
        if coefficient == 0.0:
            continue
        if kind == "EVENASPH" and 1 <= order <= _ASPHERE_PARAMETERS:
            power = 2 * order
            try:
                surface.asphere[power] = coefficient * header.scale ** (1 - power)
            except OverflowError:
                surface.asphere[power] = math.inf
        else:
            header.draft.passed_over.add(f"PARM {order} of a {kind} surface", line)


def _clear_radius(row, header):
    line, words, text = row
    if value(row, 1, header.draft) > 0.0:
        header.draft.refusals.add(
            "I04", line, f"{excerpt(text)}: an aperture with a hole round the axis"
        )
    return value(row, 2, header.draft) * header.scale


def _glass(row, header, options):
    draft = header.draft
    line, words, text = row
    if len(words) < 2:
        draft.refusals.add("I07", line, f"{excerpt(text)} names no glass")
        return AIR
    name = words[1]
    if name.upper() == "MIRROR":
        draft.refusals.add("I02", line, "a mirror; light must go on towards +z")
        return AIR
    model = len(words) > 2 and words[2] == "1"
    if model or name.upper() == "___BLANK":
        nd, vd = value(row, 4, draft), value(row, 5, draft)
        deviation = number(words[6]) if len(words) > 6 else 0.0
        return ConstantGlass(nd) if vd == 0.0 else AbbeGlass(nd, vd, deviation or 0.0)
    try:
        glass, note = named_glass(name, options, header.words("GCAT"))
    except UnknownGlassError as error:
        draft.refusals.add("I05", line, str(error))
        return AIR
    if note and note not in draft.notes:
        draft.notes.append(note)
    return glass


def _read_other(row, draft):
    line, words, text = row
    keyword = words[0]
    if keyword in _OTHER_RIMS:
        draft.refusals.add("I04", line, f"{excerpt(text)}: an aperture that is no round rim")
    elif keyword == "OBDC" and any(number(word) != 0.0 for word in words[1:]):
        draft.refusals.add("I03", line, f"{excerpt(text)}: an aperture off the axis")
    elif keyword == "COMM" and len(words) > 1:
        draft.notes.append(f"Surface comment: {clean(text)[len('COMM ') :]}")
    else:
        draft.passed_over.add(keyword[:20], line)


def _name(header):
    row = header.last("NAME")
    header.draft.name = clean(row[2])[len("NAME ") :] if row else ""
    for _, words, text in header.rows.get("NOTE", []):
        # The number in front of the text is the line of the note.
        start = 2 if len(words) > 1 and whole_number(words[1]) is not None else 1
        said = clean(text).split(" ", start)[start:]
        header.draft.notes.extend(said)


def _pass_over_header(header):
    read = _READ_WORDS | READ_WORDS | set(APERTURES)
    for keyword, rows in header.rows.items():
        for line, _, _ in rows if keyword not in read else ():
            header.draft.passed_over.add(clean(keyword)[:20], line)
