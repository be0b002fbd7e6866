"""Lens files of every format: ours, and those of other programs as `lens import` reads them."""

from pathlib import Path

from ..errors import LensFileError
from .toml.findings import Finding
from .toml.toml_reader import LensFile, read_lens

# Of the formats that can be imported.
FOREIGN_ENDINGS = frozenset({".dat", ".zmx", ".seq", ".txt"})


def read_any_lens(path):
    """Read a lens file; one in a foreign format without any of the options of an import.

    Parameters
    ----------
    path : Path or str

    Returns
    -------
    LensFile
        Its warnings begin with what a foreign file has beyond a prescription (W07).

    Raises
    ------
    LensFileError
        With every error of the file.
    """
    path = Path(path)
    if path.suffix.lower() not in FOREIGN_ENDINGS:
        return read_lens(path)
    # Only who reads foreign files needs their importers; Blender starts sooner without.
    from .importers import import_lens

    try:
        imported = import_lens(path)
    except LensFileError as error:
        raise _with_advice(error) from error
    ignored = (Finding("W07", "", f"read past: {sentence}") for sentence in imported.ignored)
    return LensFile(imported.prescription, (*ignored, *imported.warnings), path)


def _with_advice(error):
    # What a file leaves open is settled by options that only one command has.
    found = [
        Finding(one.code, one.path, f"{one.message} (options of `aplanat lens import`)")
        if one.code in ("I05", "I06")
        else one
        for one in error.findings
    ]
    return LensFileError(error.file_name, found, error.warnings)
