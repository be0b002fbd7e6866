"""The tables of a lens file besides its surfaces: lens, diaphragm, zoom and focus."""

from dataclasses import replace

from ...optics.prescription import Diaphragm, FocusGroup, ZoomPosition
from .surface_tables import NOT_NEGATIVE, POSITIVE, check_asphere, check_rim
from .toml_table import Range, Table, key_path, show

LENS_KEYS = (
    "name",
    "designer",
    "source",
    "year",
    "notes",
    "focal_length_mm",
    "f_number",
    "half_field_deg",
    "projection",
    "image_circle_diameter_mm",
)
DIAPHRAGM_KEYS = ("blades", "blade_curvature", "rotation_deg")
ZOOM_KEYS = (
    "label",
    "focal_length_mm",
    "f_number",
    "half_field_deg",
    "stop_semi_diameter_mm",
    "thickness_mm",
)
FOCUS_KEYS = ("first", "last")
LONGEST_NAME = 200
FEWEST_POSITIONS, MOST_POSITIONS = 2, 50
HALF_FIELD = Range(0.0, 90.0, above=True, below=True)
YEAR = Range(1600, 2200)
CURVATURE = Range(0.0, 1.0)
FEWEST_BLADES, MOST_BLADES = 3, 32
_NOMINAL = {"focal_length_mm": POSITIVE, "f_number": POSITIVE, "half_field_deg": HALF_FIELD}


def read_lens_table(document):
    """Read `[lens]`.

    Parameters
    ----------
    document : Table
        Notes E05 to E10.

    Returns
    -------
    dict
        Fields of `Prescription` by name; None for what is not known.
    """
    table = document.table("lens", LENS_KEYS) if document.require("lens") else None
    if table is None:
        return {"name": None} | dict.fromkeys(("focal_length", "f_number", "half_field_deg"))
    return {
        "name": _name(table),
        **_nominal_values(table),
        "designer": table.text("designer"),
        "source": table.text("source"),
        "year": table.integer("year", YEAR),
        "notes": table.text("notes"),
        "projection": table.choice("projection", ("rectilinear", "fisheye"), "rectilinear"),
        "image_circle_diameter": table.number("image_circle_diameter_mm", POSITIVE),
    }


def read_diaphragm(document):
    """Read `[diaphragm]`; notes E05, E07 to E09 and E23.

    Parameters
    ----------
    document : Table

    Returns
    -------
    Diaphragm
        A round opening if there is no such table.
    """
    table = document.table("diaphragm", DIAPHRAGM_KEYS)
    if table is None:
        return Diaphragm()
    blades = table.integer("blades", default=0)
    if blades is not None and blades != 0 and not FEWEST_BLADES <= blades <= MOST_BLADES:
        table.add(
            "E23",
            "blades",
            f"{show(blades)} blades are not possible; allowed are 0 (round) and "
            f"{FEWEST_BLADES} to {MOST_BLADES}",
        )
    return Diaphragm(
        blades,
        table.number("blade_curvature", CURVATURE, default=0.0),
        table.number("rotation_deg", default=0.0),
    )


def read_focus(document, surface_tables):
    """Read `[focus]`, the group that moves for focusing; notes E05 to E07, E21 and E22.

    Parameters
    ----------
    document : Table
    surface_tables : SurfaceTables or None

    Returns
    -------
    FocusGroup or None
        None if the whole lens moves.
    """
    table = document.table("focus", FOCUS_KEYS)
    if table is None:
        return None
    ends = []
    for key in FOCUS_KEYS:
        name = table.text(key) if table.require(key) else None
        if name is None or surface_tables is None:
            continue
        if name not in surface_tables.numbers:
            hint = table.hint(name, surface_tables.numbers)
            table.add(
                "E21",
                key,
                f"the focus group names {show(name)}, an id that no surface has{hint}",
            )
        else:
            ends.append(surface_tables.numbers[name])
    if len(ends) < len(FOCUS_KEYS):
        return None
    if ends[0] > ends[1]:
        table.add(
            "E22",
            "last",
            f"the focus group goes from surface {ends[0]} to surface {ends[1]}; "
            "its last surface must not stand in front of its first",
        )
        return None
    return FocusGroup(*ends)


def read_zoom(document, surface_tables):
    """Read `[[zoom]]`.

    Parameters
    ----------
    document : Table
        Notes E05 to E09, E14, E21 and E22.
    surface_tables : SurfaceTables or None

    Returns
    -------
    list of (ZoomPosition or None)
        None for a position of which the distances or the stop are not known; nominal values that
        are not known are None. Empty for a lens without zoom.
    """
    rows = document.tables("zoom")
    if rows is None:
        return []
    findings = document.findings
    if not FEWEST_POSITIONS <= len(rows) <= MOST_POSITIONS:
        findings.add(
            "E22",
            "zoom",
            f"the file has {len(rows)} zoom position{'s' * (len(rows) != 1)}; a zoom lens has "
            f"{FEWEST_POSITIONS} to {MOST_POSITIONS}",
        )
    tables = [
        None if row is None else Table(row, f"zoom[{number}]", findings, ZOOM_KEYS)
        for number, row in enumerate(rows[:MOST_POSITIONS], 1)
    ]
    nominal = [{} if table is None else _nominal_values(table) for table in tables]
    positions = [
        None if table is None else _position(table, values, surface_tables)
        for table, values in zip(tables, nominal, strict=True)
    ]
    for number in _check_same_ids(tables, surface_tables):
        positions[number - 1] = None
    _check_rising(tables, [values.get("focal_length") for values in nominal])
    return positions


def _name(table):
    name = table.text("name") if table.require("name") else None
    if name is not None and not 1 <= len(name) <= LONGEST_NAME:
        table.add(
            "E10", "name", f"the name has {len(name)} characters; allowed are 1 to {LONGEST_NAME}"
        )
        return None
    return name


def _nominal_values(table):
    values = {}
    for key, allowed in _NOMINAL.items():
        value = table.number(key, allowed) if table.require(key) else None
        values[key.removesuffix("_mm")] = value
    return values


def _position(table, nominal, surface_tables):
    label = table.text("label") if table.require("label") else None
    stop = table.number("stop_semi_diameter_mm", POSITIVE)
    inner = table.table("thickness_mm") if table.require("thickness_mm") else None
    known = inner is not None and (stop is not None or "stop_semi_diameter_mm" not in table)
    thicknesses = {}
    for name in inner.values if inner else ():
        thicknesses[name] = inner.number(name, NOT_NEGATIVE)
        known = known and thicknesses[name] is not None
        if surface_tables is not None and name not in surface_tables.numbers:
            hint = inner.hint(name, surface_tables.numbers)
            inner.add(
                "E21",
                name,
                f"zoom position {_title(table)} sets the distance behind {show(name)}, an id that "
                f"no surface has{hint}",
            )
            known = False
    if stop is not None and surface_tables is not None:
        for surface in surface_tables.surfaces:
            if surface is not None and surface.is_stop:
                before = len(table.findings.errors)
                path = table.at("stop_semi_diameter_mm")
                check_rim(surface, stop, path, table.findings)
                check_asphere(replace(surface, semi_diameter=stop), path, table.findings)
                known = known and len(table.findings.errors) == before
    if not known:
        return None
    return ZoomPosition(label=label, **nominal, thicknesses=thicknesses, stop_semi_diameter=stop)


def _check_same_ids(tables, surface_tables):
    """Compare the ids of each position with the first one's; return those that differ."""
    known = None if surface_tables is None else surface_tables.numbers
    first, different = None, []
    for number, table in enumerate(tables, 1):
        inner = None if table is None else table.values.get("thickness_mm")
        if not isinstance(inner, dict):
            continue
        ids = {name for name in inner if known is None or name in known}
        if first is None:
            first, first_number = ids, number
        if ids != first:
            different.append(number)
        for name in sorted(ids ^ first):
            verb = "does not set" if name in first else "sets"
            other = "does" if name in first else "does not"
            table.findings.add(
                "E21",
                key_path(table.at("thickness_mm"), name),
                f"zoom position {_title(table)} {verb} the distance behind {show(name)}, which "
                f"position {first_number} {other}; every position must set the same ids",
            )
    return different


def _check_rising(tables, focal_lengths):
    before = None
    for table, value in zip(tables, focal_lengths, strict=True):
        if value is None:
            continue
        if before is not None and not value > before:
            table.add(
                "E22",
                "focal_length_mm",
                f"{value!r} follows {before!r}; focal lengths of zoom positions must rise",
            )
        before = value


def _title(table):
    label = table.values.get("label")
    number = table.path[len("zoom[") : -1]
    return f"{number} ({show(label)})" if isinstance(label, str) else number
