"""Importer of optical-bench tables: tab-separated text in sections, widely used for patent lenses.

``[lens data]`` has number, radius (or AS for the stop, FS for a field stop, CG for a cover glass),
thickness, nd, diameter, vd, and perhaps the name of the glass; a thickness may be a name whose
values, one per column, stand in ``[variable distances]``. ``[aspherical data]`` has number, radius,
conic constant and a4, a6 ...; the constant ``AsphericalA2`` puts an a2 first, and
``AsphericalOddCount`` means a3, a4, a5 ... Magnification and ``d0``, the object distance, tell
which columns focus near.

References
----------
The tables of photonstophotos.net and the programs that read them.
"""

import math
import re

from ...optics.glass import REFERENCE_WAVELENGTH_NM, AbbeGlass, ConstantGlass
from .draft.draft import Draft, DraftPosition, DraftSurface, Field, Opening
from .draft.source_text import clean, excerpt, number

FORMAT_NAME = "optical-bench table"
_SECTIONS = (
    "descriptive data",
    "constants",
    "variable distances",
    "lens data",
    "aspherical data",
    "figure",
    "notes",
)
# Spaces that part cells; a single one parts the words of a cell.
_RUNS = re.compile(r" {2,}")
_PLANES = {"AS", "FS", "CG", "INFINITY"}
# Number, radius, thickness, nd, diameter, vd, name and maker of the glass.
_COLUMNS = 8
# What a lens file may have.
_MOST_COLUMNS = 50
# Radii of the two tables agree to the digits that a patent prints.
_SAME_RADIUS = 1.0e-3


def looks_like(lines):
    """Return whether there is a section of lens data.

    Parameters
    ----------
    lines : list of (int, str)

    Returns
    -------
    bool
    """
    return any(_section(text) == "lens data" for _, text in lines)


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
    reader = _Reader()
    section = None
    spaces = _spaces_of_a_tab(lines)
    for line, text in lines:
        if not text.strip() or text.lstrip().startswith("#"):
            continue
        if text.lstrip().startswith("["):
            section = _section(text)
            if section is None:
                reader.draft.passed_over.add(f"section {clean(text)[:30]}", line)
            continue
        if reader.draft.is_full(len(reader.rows), line):
            break
        reader.take(section, line, _cells(text, spaces), text)
    return reader.finish(options)


def _spaces_of_a_tab(lines):
    """Return how many spaces stand for a tab in a table that was copied without its tabs.

    Parameters
    ----------
    lines : list of (int, str)

    Returns
    -------
    int or None
        None if there are tabs, or runs of spaces are not all multiples of one of two or more, as
        where columns were aligned: which cells are empty is not known then.
    """
    if any("\t" in text for _, text in lines):
        return None
    runs = {len(run) for _, text in lines for run in _RUNS.findall(text.strip())}
    return min(runs) if runs and not any(run % min(runs) for run in runs) else None


def _cells(text, spaces):
    separator = " " * spaces if spaces else "\t"
    return [cell.strip() for cell in text.strip(" ").split(separator)]


def _section(text):
    name = text.strip().strip("[]").lower()
    return name if text.strip().startswith("[") and name in _SECTIONS else None


class _Reader:
    """Collects the rows of the sections."""

    def __init__(self):
        self.draft = Draft()
        self.variables = {}
        self.constants = set()
        self.rows = []
        self.aspheres = {}

    def take(self, section, line, cells, text):
        """Take in one row."""
        name = cells[0].lower()
        if section == "descriptive data":
            if name == "title":
                self.draft.name = self.draft.source = clean(" ".join(cells[1:]))
            else:
                self.draft.notes.append(clean(" ".join(cells)))
        elif section == "constants":
            self.constants.add(name)
            if name not in ("asphericaloddcount", "asphericala2"):
                self.draft.passed_over.add(f"constant {clean(cells[0])[:30]}", line)
        elif section == "variable distances":
            if name in self.variables:
                self.draft.refusals.add("I07", line, f"{excerpt(text)} is there more than once")
            self.variables[name] = (line, _without_tail(cells[1:]))
        elif section == "lens data":
            self.rows.append((line, cells, text))
        elif section == "aspherical data":
            if name in self.aspheres:
                self.draft.refusals.add("I07", line, f"{excerpt(text)} is there more than once")
            self.aspheres[name] = (line, _without_tail(cells), text)
        elif section == "notes":
            self.draft.notes.append(clean(text))
        else:
            self.draft.passed_over.add(f"[{section}]" if section else "row in no section", line)

    def finish(self, options):
        """Make the surfaces and the zoom positions of the rows."""
        draft = self.draft
        if not self.rows:
            draft.refusals.add("I07", None, "there are no rows in [lens data]")
            return draft
        columns = self._far_columns()
        distances = []
        for index, (line, cells, text) in enumerate(self.rows, 1):
            draft.surfaces.append(self._surface(index, line, cells, text))
            distances.append(self._distances(line, cells, text, columns))
        self._advise_tabs()
        self._apply_aspheres()
        for surface, thicknesses in zip(draft.surfaces, distances, strict=True):
            surface.thickness = thicknesses[0]
        draft.opening, draft.field = self._opening(columns[0]), self._field(columns[0])
        height = self._number("image height", columns[0])
        draft.image_circle_diameter = height if height and height > 0.0 else None
        draft.focal_length = self._number("focal length", columns[0])
        draft.f_number = self._number("f-number", columns[0])
        draft.image_distance_told &= draft.surfaces[-1].thickness != 0.0
        if len(columns) > 1:
            draft.positions = [
                DraftPosition(
                    [thicknesses[place] for thicknesses in distances],
                    self._opening(column),
                    self._field(column),
                    self._stop_radius(column),
                    self._number("focal length", column),
                    self._number("f-number", column),
                )
                for place, column in enumerate(columns)
            ]
        self._stop_rim(columns[0])
        draft.choose_stop(options)
        self._pass_over_variables()
        return draft

    def _advise_tabs(self):
        # Rows without tabs look right, and cannot be told apart.
        if self.draft.refusals and not any("\t" in text for _, _, text in self.rows):
            self.draft.refusals.add(
                "I07",
                self.rows[0][0],
                "the rows of [lens data] have no tabs; part the cells by tabs, or each tab by the"
                " same number of spaces (two or more), so that empty cells can be told",
            )

    def _far_columns(self):
        # The columns with the object at infinity, as far as their focal lengths rise.
        count = max((len(cells) for _, cells in self.variables.values()), default=1)
        if count > _MOST_COLUMNS:
            self.draft.refusals.add(
                "E09", None, f"{count} columns of distances; a lens may have {_MOST_COLUMNS}"
            )
            count = 1
        everything = range(max(1, count))
        far = [column for column in everything if self._is_far(column)]
        if not far:
            self.draft.image_distance_told = False
            self.draft.object_distance = self._number("d0", 0) or math.inf
            self.draft.notes.append("No column of the table has its object at infinity.")
        chosen = far or [0]
        lengths = [self._number("focal length", column) for column in chosen]
        known = [length for length in lengths if length is not None]
        zooms = len(known) == len(chosen) and len(set(known)) == len(known)
        if not zooms:
            chosen = chosen[:1]
        if len(chosen) < len(everything):
            line = min(line for line, cells in self.variables.values() if len(cells) == count)
            left = [str(column + 1) for column in everything if column not in chosen]
            self.draft.passed_over.add(
                f"columns {', '.join(left)} of the distances, which show how the lens focuses", line
            )
        return chosen

    def _is_far(self, column):
        distance = self._cell("d0", column)
        magnification = self._number("magnification", column)
        near = distance is not None and distance.lower() not in ("infinity", "undefined", "")
        return not near and not magnification

    def _cell(self, name, column):
        # A row with one value holds for every column.
        _, cells = self.variables.get(name, (0, []))
        if not cells:
            return None
        return cells[column] if column < len(cells) else cells[0] if len(cells) == 1 else None

    def _number(self, name, column):
        cell = self._cell(name, column)
        return None if cell is None else number(cell)

    def _surface(self, index, line, cells, text):
        surface = DraftSurface(line, index)
        refuse = self.draft.refusals.add
        cells = [*cells, *[""] * _COLUMNS]
        radius = number(cells[1])
        if radius is not None:
            surface.radius = radius if radius != 0.0 else math.inf
        elif cells[1].upper() not in _PLANES:
            refuse("I07", line, f"{excerpt(text)}: the radius is no number, AS, FS, CG, Infinity")
        surface.is_stop = cells[1].upper() == "AS"
        index_of_glass, abbe = number(cells[3]), number(cells[5])
        for cell, value in ((cells[3], index_of_glass), (cells[5], abbe)):
            if cell and value is None:
                refuse("I07", line, f"{excerpt(text)}: nd and vd must be numbers or empty")
        if index_of_glass not in (None, 0.0, 1.0):
            surface.glass = (
                AbbeGlass(index_of_glass, abbe) if abbe else ConstantGlass(index_of_glass)
            )
        diameter = number(cells[4])
        if diameter is None and cells[4].lower() not in ("", "undefined", "aperture diameter"):
            refuse("I07", line, f"{excerpt(text)}: the diameter is no number")
        surface.semi_diameter = diameter / 2.0 if diameter else None
        if cells[6]:
            self.draft.passed_over.add("name of a glass; nd and vd are in the table", line)
        return surface

    def _distances(self, line, cells, text, columns):
        name = cells[2] if len(cells) > 2 else ""
        value = number(name)
        if value is not None:
            return [value] * len(columns)
        found = [self._number(name.lower(), column) for column in columns]
        if None in found or not name:
            self.draft.refusals.add(
                "I07",
                line,
                f"{excerpt(text)}: the thickness is no number, and [variable distances] has no"
                " such value for each column",
            )
        return [0.0 if value is None else value for value in found]

    def _apply_aspheres(self):
        rows = zip(self.rows, self.draft.surfaces, strict=True)
        surfaces = {cells[0].lower(): surface for (_, cells, _), surface in rows}
        odd = "asphericaloddcount" in self.constants
        first = 3 if odd else 2 if "asphericala2" in self.constants else 4
        for name, (line, cells, text) in self.aspheres.items():
            values = [number(cell) if cell else 0.0 for cell in cells[1:]]
            if cells[1:2] and cells[1].upper() in _PLANES:
                values[0] = 0.0
            surface = surfaces.get(name)
            if surface is None or None in values or len(values) < 2:
                self.draft.refusals.add(
                    "I07",
                    line,
                    f"{excerpt(text)} is not the number of a surface, its radius, the conic"
                    " constant and coefficients",
                )
                continue
            radius = values[0] or math.inf
            if not _same_radius(radius, surface.radius):
                self.draft.refusals.add(
                    "I07", line, f"{excerpt(text)}: [lens data] has radius {surface.radius:g}"
                )
            surface.conic = values[1]
            for order, value in enumerate(values[2:]):
                power = first + (order if odd else 2 * order)
                if value and power % 2:
                    self.draft.refusals.add("I04", line, f"{excerpt(text)}: odd term a{power}")
                elif value:
                    surface.asphere[power] = value

    def _stop_radius(self, column):
        diameter = self._number("aperture diameter", column)
        return diameter / 2.0 if diameter else None

    def _stop_rim(self, column):
        radius = self._stop_radius(column)
        for surface in self.draft.surfaces:
            if surface.is_stop and radius is not None:
                surface.semi_diameter = radius

    def _opening(self, column):
        stop = next((s for s in self.draft.surfaces if s.is_stop), None)
        if self._stop_radius(column) or (stop is not None and stop.semi_diameter):
            return Opening("stop", 0.0, REFERENCE_WAVELENGTH_NM)
        f_number = self._number("f-number", column)
        return Opening("f-number", f_number, REFERENCE_WAVELENGTH_NM) if f_number else None

    def _field(self, column):
        angle = self._number("angle of view", column)
        if angle and 0.0 < angle < 180.0:
            return Field("angle", (angle / 2.0,))
        height = self._number("image height", column)
        return Field("image height", (height / 2.0,)) if height and height > 0.0 else None

    def _pass_over_variables(self):
        used = {cells[2].lower() for _, cells, _ in self.rows if len(cells) > 2}
        used |= {"focal length", "f-number", "angle of view", "aperture diameter", "d0"}
        used |= {"image height", "magnification"}
        for name, (line, _) in self.variables.items():
            if name not in used:
                self.draft.passed_over.add(f"'{clean(name)[:30]}' of the distances", line)


def _without_tail(cells):
    while cells and not cells[-1]:
        cells = cells[:-1]
    return cells


def _same_radius(one, other):
    if math.isinf(one) or math.isinf(other):
        return math.isinf(one) and math.isinf(other)
    return abs(one - other) <= _SAME_RADIUS * max(abs(one), abs(other))
