"""Foreign lens files to prescriptions: finds out the format, reads, completes, checks."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import LensFileError
from ...optics.prescription import Prescription
from ..toml.findings import Finding
from . import optical_bench, pbrt
from .codev import codev
from .completion import complete
from .draft.options import ImportOptions
from .draft.source_text import MOST_LINES, clean, decode, numbered_lines, read_source, size_finding
from .zemax import zemax

# In the order in which their contents are told apart: from the most to the least distinct.
FORMATS = (optical_bench, zemax, codev, pbrt)
ENDINGS = {".txt": optical_bench, ".zmx": zemax, ".seq": codev, ".dat": pbrt}


@dataclass(frozen=True)
class ImportedLens:
    """A lens of a foreign file.

    Parameters
    ----------
    prescription : Prescription
        Its notes say what was computed.
    ignored : tuple of str
        What the file has beyond a prescription, with line numbers.
    warnings : tuple of Finding
        W01 to W06.
    format_name : str
    """

    prescription: Prescription
    ignored: tuple[str, ...]
    warnings: tuple[Finding, ...]
    format_name: str


def import_lens(path, options=None):
    """Read a lens file of another program.

    Parameters
    ----------
    path : Path or str
        pbrt lens table, sequential Zemax file, CODE V sequence or optical-bench table; the content
        tells which, and the ending where it does not.
    options : ImportOptions or None
        Answers where a file is ambiguous.

    Returns
    -------
    ImportedLens

    Raises
    ------
    LensFileError
        I01 to I08 if the file cannot be read faithfully, E01 to E25 if its lens is not possible.
    """
    content, finding = read_source(path)
    if finding is not None:
        raise LensFileError(str(path), [finding])
    return import_bytes(content, str(path), options)


def import_bytes(content, file_name, options=None):
    """Read the content of a lens file of another program.

    Parameters
    ----------
    content : bytes
    file_name : str
        For messages, its ending as a hint, its stem as the name of a lens without one.
    options : ImportOptions or None

    Returns
    -------
    ImportedLens

    Raises
    ------
    LensFileError
        As `import_lens`.
    """
    options = options or ImportOptions()
    too_large = size_finding(content)
    if too_large is not None:
        raise LensFileError(file_name, [too_large])
    text = decode(content)
    if text is None:
        raise LensFileError(file_name, [Finding("I01", "", "its bytes are no text")])
    lines = numbered_lines(text)
    if len(lines) > MOST_LINES:
        message = f"the file has {len(lines)} lines; at most {MOST_LINES} are read"
        raise LensFileError(file_name, [Finding("E01", "", message)])
    reader = _reader_of(lines, file_name)
    draft = reader.read(lines, options)
    if draft.refusals:
        raise LensFileError(file_name, draft.refusals.findings())
    draft.name = draft.name or clean(Path(file_name).stem)
    # Figures of a damaged file may overflow on the way; results are checked at the end.
    with np.errstate(all="ignore"):
        prescription, warnings = complete(draft, file_name, options)
    return ImportedLens(prescription, draft.passed_over.report(), warnings, reader.FORMAT_NAME)


def _reader_of(lines, file_name):
    for reader in FORMATS:
        if reader.looks_like(lines):
            return reader
    ending = Path(file_name).suffix.lower()
    meant = ENDINGS.get(ending)
    if meant is None:
        known = ", ".join(f"{reader.FORMAT_NAME} ({end})" for end, reader in ENDINGS.items())
        message = f"this is none of the formats that can be imported: {known}"
    else:
        message = f"the content is not that of a {meant.FORMAT_NAME}, as its ending {ending} says"
    raise LensFileError(file_name, [Finding("I01", "", message)])
