"""The `material` of a surface to its glass, and whether a glass can be used."""

import numpy as np

from ...errors import GlassNotFoundError
from ...optics.glass import (
    AIR,
    CHECKED_RANGE_NM,
    D_LINE_NM,
    AbbeGlass,
    Air,
    ConstantGlass,
    SellmeierGlass,
    SeriesGlass,
)
from ..glasses.glass_catalog import catalog_glass, near_names
from .toml_table import Range, Table, checked_number, show

MATERIAL_KEYS = ("nd", "vd", "dpgf", "sellmeier_b", "sellmeier_c_um2", "series_um")
SELLMEIER_TERMS = range(1, 7)
SERIES_TERMS = 6
ND = Range(1.0, 4.0, above=True)
VD = Range(5.0, 120.0)
# Keys that belong together; a material uses one of these sets.
_FORMS = (("nd", "vd", "dpgf"), ("sellmeier_b", "sellmeier_c_um2"), ("series_um",))


def read_material(surface):
    """Return the glass behind a surface.

    Parameters
    ----------
    surface : Table
        Notes E06 to E08 and E17 to E19.

    Returns
    -------
    Glass or None
        None if it is missing or wrong.
    """
    if not surface.require("material"):
        return None
    value = surface.values["material"]
    if isinstance(value, str):
        return _named(value, surface)
    if isinstance(value, dict):
        table = Table(value, surface.at("material"), surface.findings, MATERIAL_KEYS)
        glass = _from_table(table)
        return glass if glass is None or _is_usable(glass, table) else None
    surface.wrong_type("material", "text or a table")
    return None


def index_fault(glass):
    """Find a wavelength in the checked range at which a glass has no usable index.

    Parameters
    ----------
    glass : Glass

    Returns
    -------
    float or None
        Wavelength in nm; None if the index is real and above 1 everywhere.
    float or None
        The index there; None if it is imaginary or not finite.
    """
    if isinstance(glass, Air):
        return None, None
    pole = _pole(glass)
    if pole is not None:
        return pole, None
    low, high = CHECKED_RANGE_NM
    step = (high - low) / 300.0
    wavelengths = np.linspace(low, high, 301)
    for _ in range(4):
        with np.errstate(all="ignore"):
            index = glass.index(wavelengths)
        bad = ~(np.isfinite(index) & (index > 1.0))
        if bad.any():
            at = int(np.argmax(bad))
            value = float(index[at])
            return float(wavelengths[at]), value if np.isfinite(value) else None
        # Nearer to the lowest index found: a dip between two samples is no escape.
        lowest = float(wavelengths[np.argmin(index)])
        wavelengths = np.linspace(max(low, lowest - step), min(high, lowest + step), 101)
        step /= 50.0
    return None, None


def _named(name, surface):
    if name == "air":
        return AIR
    try:
        return catalog_glass(name)
    except GlassNotFoundError:
        near = ("air",) if name.strip().lower() == "air" else near_names(name)
        hint = f"; near names: {', '.join(show(one) for one in near)}" if near else ""
        surface.add("E17", "material", f"the glass {show(name)} is not in the catalogue{hint}")
        return None


def _from_table(table):
    found = [key for key in MATERIAL_KEYS if key in table]
    used = [form for form in _FORMS if any(key in table for key in form)]
    nd = _ranged(table, "nd", ND, f"the index at {D_LINE_NM / 1000.0:g} um")
    vd = _ranged(table, "vd", VD, f"the Abbe number at {D_LINE_NM / 1000.0:g} um")
    dpgf = table.number("dpgf", default=0.0)
    b, c_um2, series = (_numbers(table, key) for key in _FORMS[1] + _FORMS[2])
    if not table.values:
        _refuse(table, "the table is empty")
    elif len(used) > 1:
        _refuse(table, f"the keys {', '.join(found)} mix forms")
    elif used == [_FORMS[0]]:
        return _from_abbe(table, nd, vd, dpgf)
    elif used == [_FORMS[1]]:
        return _from_sellmeier(table, b, c_um2)
    elif used == [_FORMS[2]]:
        return _from_series(table, series)
    return None


def _ranged(table, key, allowed, what):
    value = table.number(key)
    if value is None or value in allowed:
        return value
    table.add("E19", key, f"{what} is {value!r}; it must be {allowed}")
    return None


def _from_abbe(table, nd, vd, dpgf):
    has_nd = table.require("nd")
    if not has_nd or ("dpgf" in table and not table.require("vd")) or None in (nd, dpgf):
        return None
    if "vd" not in table:
        return ConstantGlass(nd)
    return None if vd is None else AbbeGlass(nd, vd, dpgf)


def _from_sellmeier(table, b, c_um2):
    both = [table.require(key) for key in _FORMS[1]]
    if not all(both) or b is None or c_um2 is None:
        return None
    if len(b) != len(c_um2) or len(b) not in SELLMEIER_TERMS:
        _refuse(
            table,
            f"sellmeier_b has {len(b)} terms and sellmeier_c_um2 has {len(c_um2)}, "
            "where both need the same number, 1 to 6",
        )
        return None
    return None if None in b + c_um2 else SellmeierGlass(b, c_um2)


def _from_series(table, series):
    if series is None:
        return None
    if len(series) != SERIES_TERMS:
        _refuse(table, f"series_um has {len(series)} terms, where it needs {SERIES_TERMS}")
        return None
    return None if None in series else SeriesGlass(series)


def _refuse(table, what):
    table.findings.add(
        "E18",
        table.path,
        f"{what}; a material table is {{nd}}, {{nd, vd}}, {{nd, vd, dpgf}}, "
        "{sellmeier_b, sellmeier_c_um2} or {series_um}",
    )


def _numbers(table, key):
    """Return a list of numbers as a tuple, with None for those that are wrong."""
    if key not in table:
        return None
    listed = table.values[key]
    if not isinstance(listed, list):
        table.wrong_type(key, "an array of numbers")
        return None
    return tuple(
        checked_number(value, f"{table.at(key)}[{number}]", table.findings)
        for number, value in enumerate(listed[: 2 * SERIES_TERMS], 1)
    ) + (None,) * max(0, len(listed) - 2 * SERIES_TERMS)


def _is_usable(glass, table):
    wavelength, index = index_fault(glass)
    if wavelength is not None:
        value = "imaginary or infinite" if index is None else f"{index:.6g}"
        table.findings.add(
            "E19",
            table.path,
            f"the index is {value} at {wavelength / 1000.0:.6g} um; "
            "it must be real and greater than 1 from 0.40 to 0.70 um",
        )
        return False
    nd = float(glass.index(D_LINE_NM))
    if nd not in ND:
        table.findings.add(
            "E19",
            table.path,
            f"the index is {nd:.6g} at {D_LINE_NM / 1000.0:g} um; it must be {ND}",
        )
        return False
    return True


def _pole(glass):
    """Return a wavelength in the checked range at which a Sellmeier term is infinite, or None.

    On one side of it the index is imaginary, however small the term.
    """
    low, high = CHECKED_RANGE_NM
    for b, c in zip(getattr(glass, "b", ()), getattr(glass, "c_um2", ()), strict=True):
        if b != 0.0 and c > 0.0 and low <= 1000.0 * c**0.5 <= high:
            return 1000.0 * c**0.5
    return None
