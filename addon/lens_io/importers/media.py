"""Glasses as foreign lens files name them."""

import json
import re
from functools import cache
from pathlib import Path

from ...errors import GlassNotFoundError
from ...optics.glass import AbbeGlass
from ..glass_catalog import catalog_glass, catalog_names, near_names
from .source_text import clean, number

MAKERS_FILE = Path(__file__).with_name("maker_glasses.json")
CATALOG_MAKER = "SCHOTT"
# nd - 1 and vd as digits without points, each at least three of them.
_CODE = re.compile(r"\d{3,12}\.\d{3,12}", re.ASCII)


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
    near = near_names(clean((stem or name)[:40]))
    hint = f"; near names are {', '.join(near)}" if near else ""
    return UnknownGlassError(
        f"glass '{shown}' is in no catalogue here{hint}; give it with --glass NAME=ND,VD"
    )


@cache
def _maker_glasses():
    return json.loads(MAKERS_FILE.read_text(encoding="utf-8"))["makers"]


@cache
def _names_without_hyphens(maker):
    names = catalog_names() if maker == CATALOG_MAKER else _maker_glasses().get(maker, ())
    return {name.upper().replace("-", ""): name for name in names}
