"""The `[[surface]]` tables of a lens file."""

import math
import re
from dataclasses import dataclass, replace

from ...optics.prescription import Surface, may_overlap
from .material import read_material
from .optical_checks import asphere_fault
from .toml_table import Range, Table, show

SURFACE_KEYS = (
    "id",
    "radius_mm",
    "thickness_mm",
    "semi_diameter_mm",
    "material",
    "conic",
    "asphere",
    "stop",
    "curved_along",
    "overlap_mm",
)
ASPHERE_ORDERS = {f"a{order}_per_mm{order - 1}": order for order in range(2, 21, 2)}
FEWEST_SURFACES, MOST_SURFACES = 2, 100
ID_PATTERN = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,15}")
POSITIVE = Range(0.0, above=True)
NOT_NEGATIVE = Range(0.0)


@dataclass
class SurfaceTables:
    """The surfaces of a file, as far as its `[[surface]]` tables are valid.

    Parameters
    ----------
    surfaces : list of (Surface or None)
        None for a surface of which something is not known.
    numbers : dict of str to int
        The number of the surface with an id, from 1.
    sound : bool
        Whether all are known, their shapes exist and exactly one is the stop.
    """

    surfaces: list[Surface | None]
    numbers: dict[str, int]
    sound: bool


def read_surfaces(document):
    """Read the surfaces of a lens file.

    Parameters
    ----------
    document : Table
        Notes E05 to E09, E11 to E20.

    Returns
    -------
    SurfaceTables or None
        None if the surfaces are no array of tables, so that nothing is known of them.
    """
    rows = document.tables("surface") if "surface" in document else []
    if rows is None:
        return None
    findings = document.findings
    before = len(findings.errors)
    if not FEWEST_SURFACES <= len(rows) <= MOST_SURFACES:
        count = f"{len(rows)} surface{'s' * (len(rows) != 1)}"
        more = f"; the first {MOST_SURFACES} were checked" if len(rows) > MOST_SURFACES else ""
        findings.add(
            "E11",
            "surface",
            f"the file has {count}; it must have {FEWEST_SURFACES} to {MOST_SURFACES}{more}",
        )
    tables = [
        None if row is None else Table(row, f"surface[{number}]", findings, SURFACE_KEYS)
        for number, row in enumerate(rows[:MOST_SURFACES], 1)
    ]
    surfaces = [None if table is None else _read_surface(table) for table in tables]
    _read_overlaps(tables, surfaces)
    _check_stops(rows, findings)
    numbers = _read_ids(rows, tables)
    sound = None not in surfaces and all(
        error.code == "E05" or error.path.endswith("].id") for error in findings.errors[before:]
    )
    return SurfaceTables(surfaces, numbers, sound)


def check_rim(surface, semi_diameter, path, findings):
    """Note a rim that the shape of its surface does not reach (E14).

    Parameters
    ----------
    surface : Surface
    semi_diameter : float
        mm.
    path : str
        Of the semi-diameter in the file.
    findings : Findings
    """
    bend = 1.0 + surface.conic
    share = semi_diameter / abs(surface.radius)
    if bend * share * share > 1.0:
        largest = abs(surface.radius) / math.sqrt(bend)
        findings.add(
            "E14",
            path,
            f"{semi_diameter!r} is more than the surface reaches (radius {surface.radius!r}, "
            f"conic {surface.conic!r}); the largest possible semi-diameter is {largest:.9g} mm",
        )


def check_asphere(surface, path, findings):
    """Note an asphere whose sag is not finite everywhere inside its rim (E16).

    Parameters
    ----------
    surface : Surface
    path : str
        Of the asphere, or of the semi-diameter that makes it too wide.
    findings : Findings
    """
    failing = asphere_fault(surface)
    if failing is not None:
        findings.add(
            "E16",
            path,
            f"the sag of the asphere is not a finite number at {failing:.6g} mm from the axis, "
            f"inside the rim of {surface.semi_diameter:.6g} mm",
        )


def _read_surface(table):
    radius = _read_radius(table)
    needed = [
        radius,
        _required_number(table, "thickness_mm", NOT_NEGATIVE),
        _required_number(table, "semi_diameter_mm", POSITIVE),
        read_material(table),
        table.number("conic", default=0.0),
        _read_asphere(table),
        table.boolean("stop", default=False),
    ]
    curved_along = table.choice("curved_along", ("x", "y"))
    if None in needed or ("curved_along" in table and curved_along is None):
        return None
    name = table.values.get("id")
    # An id of another type is noted where the ids of all surfaces are compared.
    name = name if isinstance(name, str) else None
    surface = Surface(*needed, id=name, curved_along=curved_along)
    check_rim(surface, surface.semi_diameter, table.at("semi_diameter_mm"), table.findings)
    check_asphere(surface, table.at("asphere"), table.findings)
    return surface


def _read_overlaps(tables, surfaces):
    for number, table in enumerate(tables, 1):
        if table is None or "overlap_mm" not in table:
            continue
        overlap = table.number("overlap_mm", POSITIVE)
        surface = surfaces[number - 1]
        if surface is None or overlap is None:
            continue
        if surface.thickness != 0.0:
            table.add("E09", "overlap_mm", "an overlap needs thickness_mm = 0")
        elif surface.id is not None:
            table.add("E09", "overlap_mm", "a distance with an overlap cannot have an id")
        else:
            surfaces[number - 1] = replace(surface, thickness=-overlap)
            if not may_overlap(surfaces, number):
                table.add(
                    "E09",
                    "overlap_mm",
                    f"{overlap!r} is not possible: only a plane stop with one medium on both sides"
                    " may overlap with its neighbour, and no deeper than that is curved at its rim",
                )


def _read_radius(table):
    if not table.require("radius_mm"):
        return None
    radius = table.number("radius_mm", infinite=True)
    if radius == 0.0:
        table.add("E13", "radius_mm", 'the radius is 0; use inf for a plane ("radius_mm = inf")')
        return None
    return math.inf if radius is not None and math.isinf(radius) else radius


def _required_number(table, key, allowed):
    return table.number(key, allowed) if table.require(key) else None


def _read_asphere(table):
    inner = table.table("asphere")
    if inner is None:
        return None if "asphere" in table else ()
    terms, complete = [], True
    for key in inner.values:
        if key not in ASPHERE_ORDERS:
            inner.add(
                "E15",
                key,
                f"{show(key)} is no asphere key; they are a2_per_mm1, a4_per_mm3 ... "
                f"a20_per_mm19, even orders only{inner.hint(key, ASPHERE_ORDERS)}",
            )
            continue
        value = inner.number(key)
        complete = complete and value is not None
        terms.append((ASPHERE_ORDERS[key], value))
    return tuple(sorted(terms)) if complete else None


def _check_stops(rows, findings):
    marks = [None if row is None else row.get("stop", False) for row in rows]
    stops = [number for number, mark in enumerate(marks, 1) if mark is True]
    unknown = not all(isinstance(mark, bool) for mark in marks)
    if len(stops) > 1:
        shown = ", ".join(map(str, stops[:20])) + (" ..." if len(stops) > 20 else "")
        findings.add(
            "E12", "surface", f"surfaces {shown} are all stops; exactly one must have stop = true"
        )
    elif not stops and not unknown:
        none = f"none of the surfaces 1 to {len(rows)} is the stop" if rows else "there is no stop"
        findings.add("E12", "surface", f"{none}; exactly one surface must have stop = true")


def _read_ids(rows, tables):
    numbers = {}
    for number, row in enumerate(rows, 1):
        name = None if row is None else row.get("id")
        if not isinstance(name, str):
            if name is not None and number <= len(tables):
                tables[number - 1].text("id")
            continue
        table = tables[number - 1] if number <= len(tables) else None
        if table is not None and name in numbers:
            table.add(
                "E20", "id", f"the id {show(name)} is that of surface {numbers[name]} already"
            )
        elif table is not None and not ID_PATTERN.fullmatch(name):
            table.add(
                "E20",
                "id",
                f"the id {show(name)} must be a letter and up to 15 letters, digits or underscores",
            )
        numbers.setdefault(name, number)
    return numbers
