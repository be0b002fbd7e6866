"""Lens files of the user's own: importing, copying and removing them.

All of them are lens descriptions in TOML in one folder, whatever they were imported from.
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import LensFileError, OutputError
from ..files.whole_file import whole_file
from .lens_shelf import unused_id
from .library import ENDING
from .toml.findings import Finding
from .toml.toml_reader import parse_lens, read_lens
from .toml.toml_writer import lens_toml

# Longest id, so that paths stay usable everywhere.
_LONGEST_ID = 80
_NAME_LINE = re.compile(
    rb"""^name[ \t]*=[ \t]*(?:"(?:[^"\\\r\n]|\\.)*"|'[^'\r\n]*')""", re.MULTILINE
)


@dataclass(frozen=True)
class AddedLens:
    """A lens file that was added to the user's folder.

    Parameters
    ----------
    id : str
    path : Path
    name : str
        Of the lens.
    ignored : tuple of str
        What a foreign file says that a lens description cannot, one line each.
    warnings : tuple of Finding
    """

    id: str
    path: Path
    name: str
    ignored: tuple[str, ...] = ()
    warnings: tuple[Finding, ...] = ()


def import_into(folder, path, used_ids, options=None):
    """Convert a lens file of any known format and add it to the user's folder.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    path : Path
    used_ids : collection of str
        Ids that other lenses have.
    options : ImportOptions or None
        What the file leaves open; unused for a lens description.

    Returns
    -------
    AddedLens

    Raises
    ------
    LensFileError
        If the file cannot be used; it tells everything that is wrong.
    OutputError
        If the folder cannot be written to.
    """
    # Only who imports needs them; Blender starts sooner without.
    from .importers import ImportOptions, import_lens

    path = Path(path)
    if path.suffix.lower() == ENDING:
        read = read_lens(path)
        prescription, ignored, warnings = read.prescription, (), read.warnings
        try:
            content = path.read_bytes()
        except OSError as error:
            raise OutputError(f"cannot read '{path}' again: {error.strerror or error}") from error
    else:
        imported = import_lens(path, options or ImportOptions())
        prescription, ignored, warnings = imported.prescription, imported.ignored, imported.warnings
        content = lens_toml(prescription).encode("utf-8")
    added = _store(folder, id_for(path.stem), content, used_ids)
    return AddedLens(added.stem, added, prescription.name, tuple(ignored), tuple(warnings))


def keep_recorded(folder, wanted, text, used_ids):
    """Add a lens that another file kept to the user's folder.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    wanted : str
        Its id where it was recorded.
    text : str
        Of a lens file.
    used_ids : collection of str
        Ids that other lenses have.

    Returns
    -------
    AddedLens

    Raises
    ------
    LensFileError
        If the text cannot be used.
    OutputError
        If the folder cannot be written to.
    """
    read = parse_lens(text.encode("utf-8"), "recorded lens")
    added = _store(folder, id_for(wanted), text.encode("utf-8"), used_ids)
    return AddedLens(added.stem, added, read.prescription.name, (), tuple(read.warnings))


def copy_into(folder, path, used_ids):
    """Copy a lens file to the user's folder under a name and an id of its own.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    path : Path
        A lens description.
    used_ids : collection of str
        Ids that other lenses have.

    Returns
    -------
    AddedLens

    Raises
    ------
    LensFileError
        If the file cannot be used.
    OutputError
        If the folder cannot be written to.
    """
    read = read_lens(path)
    name = f"{read.prescription.name[:190]} (copy)"
    content = _renamed(Path(path), read.prescription, name)
    added = _store(folder, id_for(f"{path.stem}-copy"), content, used_ids)
    return AddedLens(added.stem, added, name, (), read.warnings)


def remove(path):
    """Delete a lens file.

    Parameters
    ----------
    path : Path

    Raises
    ------
    OutputError
        If it cannot be deleted.
    """
    try:
        Path(path).unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(f"cannot delete '{path}': {error.strerror or error}") from error


def id_for(text):
    """Return an id made from any text: lower case, words joined by hyphens.

    Parameters
    ----------
    text : str

    Returns
    -------
    str
        Not empty.
    """
    words = re.findall(r"[^\W_]+(?:[._][^\W_]+)*", text.lower())
    return "-".join(words)[:_LONGEST_ID].strip("-._") or "lens"


def _store(folder, wanted, content, used_ids):
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        same = folder / f"{wanted}{ENDING}"
        if same.is_file() and same.read_bytes() == content:
            return same
    except OSError as error:
        reason = error.strerror or error
        raise OutputError(f"cannot use the folder of lenses '{folder}': {reason}") from error
    # Names are compared as file systems do that ignore case.
    taken = {lens_id.casefold() for lens_id in used_ids}
    taken |= {path.stem.casefold() for path in folder.glob(f"*{ENDING}")}
    path = folder / f"{unused_id(wanted, taken)}{ENDING}"
    with whole_file(path) as place:
        Path(place).write_bytes(content)
    return path


def _renamed(path, prescription, name):
    """Return the text of a lens file with another name; its comments stay where that is safe."""
    wanted = replace(prescription, name=name)
    fresh = lens_toml(wanted).encode("utf-8")
    try:
        content = path.read_bytes()
    except OSError:
        return fresh
    line = next(line for line in fresh.splitlines() if line.startswith(b"name"))
    renamed = _NAME_LINE.sub(lambda _: line, content, count=1)
    try:
        return renamed if parse_lens(renamed, str(path)).prescription == wanted else fresh
    except LensFileError:
        return fresh
