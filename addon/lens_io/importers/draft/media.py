"""Glasses as foreign lens files name them."""

import json
import re
from functools import cache
from pathlib import Path

import numpy as np

from ....errors import GlassNotFoundError
from ....optics.glass import REFERENCE_WAVELENGTH_NM, AbbeGlass
from ...glasses.glass_catalog import catalog_glass, catalog_names, near_names
from .source_text import clean, number

MAKERS_FILE = Path(__file__).with_name("maker_glasses.json")
OLD_GLASSES_FILE = Path(__file__).with_name("old_glasses.json")
CATALOG_MAKER = "SCHOTT"
# nd - 1 and vd as digits without points, each at least three of them.
_CODE = re.compile(r"\d{3,12}\.\d{3,12}", re.ASCII)


# Two glasses have one index if nd agrees to the last digit that makers print, and the dispersion to
# half a per cent, less than it changes from melt to melt.
_SAME_INDEX = 1.5e-5
_SAME_ABBE_NUMBER = 0.005


class UnknownGlassError(GlassNotFoundError):
    """A glass of a foreign file that no list here has; the message says what to do."""


def named_glass(name, options, makers=()):
    """Return a glass by its name.

    Looked for among the user's own glasses, in the catalogue (dispersion formula), and in the
    lists of other makers (index and Abbe number).

    Parameters
    ----------
    name : str
    options : ImportOptions
    makers : sequence of str
        Whose lists the file refers to, the first that has the name counts; makers may use the same
        name for different glasses, so others are not looked at. The catalogue is asked for SCHOTT,
        and last.

    Returns
    -------
    Glass
    str or None
        A sentence if the glass is given by index and Abbe number only.

    Raises
    ------
    UnknownGlassError
    """
    key = name.upper()
    if key in options.glasses:
        return options.glasses[key], f"Glass {clean(name)} as the user gave it."
    for maker in (*(maker.upper() for maker in makers), CATALOG_MAKER):
        if maker == CATALOG_MAKER:
            try:
                return catalog_glass(name), None
            except GlassNotFoundError:
                continue
        values = _maker_glasses().get(maker, {}).get(key)
        if values is not None:
            nd, vd = values
            return AbbeGlass(nd, vd), f"Glass {key} by nd {nd:g} and vd {vd:g} of {maker}."
    raise _unknown(name)


def codev_glass(word, options):
    """Return a glass by its CODE V name, code or index.

    Parameters
    ----------
    word : str
        ``NBK7_SCHOTT`` (without the hyphen), ``1.5168:64.17`` or ``517.642``.
    options : ImportOptions

    Returns
    -------
    Glass
    str or None
        See `named_glass`.

    Raises
    ------
    UnknownGlassError
    """
    if word.upper() in options.glasses:
        return named_glass(word, options)
    if _CODE.fullmatch(word):
        index, abbe = word.split(".")
        return AbbeGlass(
            1.0 + int(index) / 10 ** len(index), int(abbe) / 10 ** (len(abbe) - 2)
        ), None
    if ":" in word:
        values = [number(part) for part in word.split(":")]
        if len(values) == 2 and None not in values:
            return AbbeGlass(*values), None
    name, _, maker = word.upper().rpartition("_")
    if not name:
        name, maker = maker, CATALOG_MAKER
    if name in options.glasses:
        return named_glass(name, options)
    known = _names_without_hyphens(maker).get(name.replace("-", ""))
    if known is None:
        raise _unknown(word, name)
    return named_glass(known, options, (maker,))


def _unknown(name, stem=None):
    shown = clean(name[:40])
    stem = clean((stem or name)[:40])
    found = _successor(stem.upper())
    if found is not None:
        maker, nd, vd, successor, values = found
        return UnknownGlassError(
            f"glass '{shown}' is in no catalogue here; {maker}'s {stem.upper()} has nd {nd:.5f}, vd"
            f" {vd:.2f}, and {successor} of the catalogue {values[0]:.5f}, {values[1]:.2f}; to take"
            f" that one: --glass {stem}={successor}; or give it with --glass NAME=ND,VD"
        )
    near = near_names(stem)
    hint = f"; near names are {', '.join(near)}" if near else ""
    return UnknownGlassError(
        f"glass '{shown}' is in no catalogue here{hint}; give it with --glass NAME=ND,VD or --glass"
        " NAME=GLASS of the catalogue"
    )


def _successor(name):
    """Return the glass of the catalogue that has the index of a glass of another list.

    Parameters
    ----------
    name : str
        In capitals, with or without its hyphens.

    Returns
    -------
    (str, float, float, str, (float, float)) or None
        Maker, nd and vd of the glass; name, nd and vd of the one of the catalogue. None if no list
        has the name, lists differ, or nothing in the catalogue is equal.
    """
    lists = {**_maker_glasses(), CATALOG_MAKER.capitalize(): _old_glasses()}
    plain = name.replace("-", "")
    told = [
        (maker.capitalize(), *values)
        for maker, glasses in lists.items()
        for known, values in glasses.items()
        if known.replace("-", "") == plain
    ]
    if not told or any(abs(nd - told[0][1]) > _SAME_INDEX for _, nd, _ in told):
        return None
    maker, nd, vd = told[0]
    equal = [
        (abs(values[1] - vd), len(known), known, values)
        for known, values in _catalog_values().items()
        if abs(values[0] - nd) <= _SAME_INDEX and abs(values[1] - vd) <= _SAME_ABBE_NUMBER * vd
    ]
    if not equal:
        return None
    _, _, successor, values = min(equal)
    return maker, nd, vd, successor, values


# Memo of a file that comes with Aplanat.
@cache
def _catalog_values():
    # nd and vd of every glass of the catalogue.
    lines = np.array([REFERENCE_WAVELENGTH_NM, 486.1327, 656.2725])
    indices = {name: catalog_glass(name).index(lines) for name in catalog_names()}
    return {name: (float(d), float((d - 1.0) / (f - c))) for name, (d, f, c) in indices.items()}


# Memo of a file that comes with Aplanat.
@cache
def _old_glasses():
    return json.loads(OLD_GLASSES_FILE.read_text(encoding="utf-8"))["glasses"]


# Memo of a file that comes with Aplanat.
@cache
def _maker_glasses():
    return json.loads(MAKERS_FILE.read_text(encoding="utf-8"))["makers"]


# Memo of the maker alone, and of files that come with Aplanat.
@cache
def _names_without_hyphens(maker):
    names = catalog_names() if maker == CATALOG_MAKER else _maker_glasses().get(maker, ())
    return {name.upper().replace("-", ""): name for name in names}
