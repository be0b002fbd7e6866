"""The glass catalogue: Sellmeier coefficients by name.

Names are exact after upper-casing. Old and new types, such as SF11 and N-SF11, are different
glasses and are never swapped. The figures and their source stand in `glass_catalog.json`.
"""

import json
from functools import cache, lru_cache
from pathlib import Path

from ...errors import GlassNotFoundError
from ...optics.glass import SellmeierGlass

CATALOG_FILE = Path(__file__).with_name("glass_catalog.json")
# A longer text is no misspelt glass, and comparing it with every name would take long.
LONGEST_NAME = 40


def catalog_glass(name):
    """Return a glass of the catalogue.

    Parameters
    ----------
    name : str
        In any case.

    Returns
    -------
    SellmeierGlass
        Its `name` is the catalogue's spelling.

    Raises
    ------
    GlassNotFoundError
        If the catalogue has no such glass; the message has up to three near names.
    """
    found = _glasses().get(name.upper()) if name.isascii() else None
    if found is None:
        near = near_names(name)
        hint = f"; near names are {', '.join(near)}" if near else ""
        raise GlassNotFoundError(f"the catalogue has no glass '{name[:LONGEST_NAME]}'{hint}")
    return found


def catalog_names():
    """Return the names of all glasses, sorted.

    Returns
    -------
    tuple of str
    """
    return tuple(sorted(glass.name for glass in _glasses().values()))


# Memo of the text alone, and of the catalogue that comes with Aplanat.
@lru_cache(maxsize=256)
def near_names(name):
    """Return up to three names of the catalogue that resemble a text, the nearest first.

    Parameters
    ----------
    name : str

    Returns
    -------
    tuple of str
        Empty if none is close.
    """
    from difflib import get_close_matches

    if len(name) > LONGEST_NAME:
        return ()
    known = _glasses()
    return tuple(known[near].name for near in get_close_matches(name.upper(), known, 3, 0.6))


# Memo of a file that comes with Aplanat.
@cache
def _glasses():
    listed = json.loads(CATALOG_FILE.read_text(encoding="utf-8"))["glasses"]
    return {
        name.upper(): SellmeierGlass(tuple(entry["b"]), tuple(entry["c_um2"]), name)
        for name, entry in listed.items()
    }
