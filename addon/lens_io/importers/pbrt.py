"""Importer of pbrt lens tables (``.dat``).

Four numbers a row: radius, thickness, index behind the surface, diameter; mm, scene side first; `#`
starts a comment. Index 0 marks the stop. Two dialects share the ending and the column header: the
thickness is the gap behind the row (its last row has 0), or, in older files, the gap in front of it
(its first row has 0). Tables of ISET have the focal length in mm in a row of its own in front. The
tables tell no dispersion, field, f-number or image distance.
"""

import math

from ...optics.glass import AIR, REFERENCE_WAVELENGTH_NM, ConstantGlass
from .draft.draft import Draft, DraftSurface, Opening
from .draft.source_text import clean, excerpt, number

FORMAT_NAME = "pbrt lens table"
_COLUMNS = ("radius", "thickness", "index", "aperture")
# Words of the column header, which is no name for a lens.
_HEADER_WORDS = {"radius", "axpos", "n", "aperture", "thickness", "sep", "sd", "v-no", "diameter"}


def looks_like(lines):
    """Whether the first line that is no comment has three to five numbers, or one before such.

    Parameters
    ----------
    lines : list of (int, str)

    Returns
    -------
    bool
    """
    rows = (line.partition("#")[0].split() for _, line in lines)
    rows = (row for row in rows if row)
    words = next(rows, ())
    if len(words) == 1 and number(words[0]) is not None:
        words = next(rows, ())
    return 3 <= len(words) <= 5 and all(number(word) is not None for word in words)


def read(lines, options):
    """Read a table.

    Parameters
    ----------
    lines : list of (int, str)
    options : ImportOptions

    Returns
    -------
    Draft
    """
    draft = Draft(opening=Opening("stop", 0.0, REFERENCE_WAVELENGTH_NM), image_distance_told=False)
    rows = _read_rows(lines, draft)
    if draft.refusals or not rows:
        if not draft.refusals:
            draft.refusals.add("I07", None, "the table has no rows of four numbers")
        return draft
    distances = _distances(rows, options, draft)
    before = AIR
    for index, (line, (radius, _, medium, diameter)) in enumerate(rows):
        surface = DraftSurface(line, index + 1, radius or math.inf, distances[index], diameter / 2)
        surface.glass = AIR if medium in (0.0, 1.0) else ConstantGlass(medium)
        if medium == 0.0 and (radius != 0.0 or before is not AIR):
            where = "behind glass" if radius == 0.0 else f"with radius {radius:g}"
            draft.refusals.add(
                "I07", line, f"index 0 marks the stop, a plane in air, but stands {where}"
            )
        draft.surfaces.append(surface)
        before = surface.glass
    _mark_stops(draft, rows)
    draft.choose_stop(options)
    return draft


def _read_rows(lines, draft):
    rows, comments, focal_length = [], [], None
    for line, text in lines:
        text, mark, comment = text.partition("#")
        if mark and clean(comment):
            comments.append(clean(comment))
        words = text.split()
        if not words:
            continue
        if draft.is_full(len(rows), line):
            break
        values = [number(word) for word in words]
        if len(words) == 1 and values[0] and values[0] > 0.0 and not rows and not focal_length:
            focal_length = draft.focal_length = values[0]
        elif len(words) != len(_COLUMNS) or None in values:
            draft.refusals.add(
                "I07",
                line,
                f"{excerpt(text)} is not four numbers: {', '.join(_COLUMNS)}",
            )
        else:
            rows.append((line, values))
    titles = [text for text in comments if not set(text.lower().split()) <= _HEADER_WORDS]
    draft.name = titles[0] if titles else ""
    draft.notes.extend(comments)
    return rows


def _distances(rows, options, draft):
    thicknesses = [values[1] for _, values in rows]
    first_is_zero, last_is_zero = thicknesses[0] == 0.0, thicknesses[-1] == 0.0
    if first_is_zero == last_is_zero:
        dialect = options.thickness
        if dialect is None:
            ends = "both" if first_is_zero else "neither"
            draft.refusals.add(
                "I06",
                rows[-1][0],
                f"the thickness is the gap before or behind each row, but {ends} of the first"
                " and the last one are 0; choose with --thickness before|after",
            )
            return thicknesses
    else:
        dialect = "before" if first_is_zero else "after"
        if options.thickness not in (None, dialect):
            line = rows[0 if first_is_zero else -1][0]
            draft.passed_over.add(f"option --thickness: a thickness of 0 tells '{dialect}'", line)
    outer = 0 if dialect == "before" else -1
    if thicknesses[outer] != 0.0:
        what = "distance in front of the lens" if outer == 0 else "distance behind the lens"
        draft.passed_over.add(f"{what}, {thicknesses[outer]:g} mm", rows[outer][0])
    return [*thicknesses[1:], 0.0] if dialect == "before" else [*thicknesses[:-1], 0.0]


def _mark_stops(draft, rows):
    # Index 0 is the mark; a table without it may have one plane in air instead.
    marked = [index for index, (_, values) in enumerate(rows) if values[2] == 0.0]
    if not marked:
        before = AIR
        for index, surface in enumerate(draft.surfaces):
            if surface.is_flat and surface.glass is AIR and before is AIR:
                marked.append(index)
            before = surface.glass
    for index in marked:
        draft.surfaces[index].is_stop = True
