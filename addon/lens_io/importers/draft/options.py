"""Options of an import: the user's choices where a foreign lens file is ambiguous."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from ....errors import GlassNotFoundError, InputError
from ....optics.glass import AbbeGlass, ConstantGlass
from ...glasses.glass_catalog import catalog_glass

_NUMBER = re.compile(r"\d{1,4}(\.\d{1,20})?", re.ASCII)
# What a lens file may say of a glass.
_LARGEST_INDEX = 4.0
_ABBE_NUMBERS = (5.0, 120.0)


@dataclass(frozen=True)
class ImportOptions:
    """Answers to what a file does not say. None: the user did not choose.

    An option never overrules the file: where the file is clear, the option has no effect and the
    report of the import says so.

    Parameters
    ----------
    thickness : str or None
        pbrt: each row's thickness is the gap "before" or "after" its surface.
    stop : int or None
        Number of the stop in the file: surfaces (or rows) from 1, the object not counted.
    radii : str or None
        CODE V: the first number of a surface is a "radius" or a "curvature".
    f_number : float or None
        Wide open, if the file tells no aperture.
    half_field_deg : float or None
        If the file tells no field.
    glasses : mapping of str to Glass
        Glasses that the catalogue does not have, by the name in the file.

    Raises
    ------
    InputError
        If a value is not one of these.
    """

    thickness: str | None = None
    stop: int | None = None
    radii: str | None = None
    f_number: float | None = None
    half_field_deg: float | None = None
    glasses: Mapping = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self):
        """Check that all options have a meaning."""
        _check_word("thickness", self.thickness, ("before", "after"))
        _check_word("radii", self.radii, ("radius", "curvature"))
        if self.stop is not None and (isinstance(self.stop, bool) or self.stop < 1):
            raise InputError(f"import option stop is {self.stop}; surfaces are counted from 1")
        _check_range("f_number", self.f_number, math.inf)
        _check_range("half_field_deg", self.half_field_deg, 90.0)
        named = {name.upper(): glass for name, glass in dict(self.glasses).items()}
        object.__setattr__(self, "glasses", MappingProxyType(named))


def glass_option(text):
    """Read a glass that the user names.

    Parameters
    ----------
    text : str
        ``NAME=ND,VD``, ``NAME=ND`` for a glass without dispersion, or ``NAME=GLASS`` for one of the
        catalogue.

    Returns
    -------
    str
        The name as it stands in the lens file.
    AbbeGlass, ConstantGlass or SellmeierGlass

    Raises
    ------
    InputError
        If it is not of this form, or no glass has such values.
    """
    name, _, values = text.partition("=")
    parts = [part.strip() for part in values.split(",")]
    if name.strip() and len(parts) == 1 and parts[0][:1].isalpha():
        try:
            return name.strip(), catalog_glass(parts[0])
        except GlassNotFoundError as error:
            raise InputError(f"glass '{text[:60]}': {error}") from error
    if not name.strip() or len(parts) > 2 or not all(_NUMBER.fullmatch(part) for part in parts):
        raise InputError(
            f"glass '{text[:60]}' must be NAME=ND,VD or NAME=GLASS, such as BK7=1.5168,64.17 or"
            " BK7=N-BK7"
        )
    nd, *rest = (float(part) for part in parts)
    if not 1.0 < nd <= _LARGEST_INDEX:
        raise InputError(f"glass '{text[:60]}': nd must be above 1 and at most {_LARGEST_INDEX:g}")
    low, high = _ABBE_NUMBERS
    if rest and not low <= rest[0] <= high:
        raise InputError(f"glass '{text[:60]}': vd must be {low:g} to {high:g}")
    return name.strip(), AbbeGlass(nd, rest[0]) if rest else ConstantGlass(nd)


def _check_word(name, value, allowed):
    if value is not None and value not in allowed:
        raise InputError(f"import option {name} is '{value}'; it must be {' or '.join(allowed)}")


def _check_range(name, value, high):
    if value is not None and not (0.0 < value < high and math.isfinite(value)):
        upper = "" if math.isinf(high) else f" and below {high:g}"
        raise InputError(f"import option {name} is {value:g}; it must be above 0{upper}")
