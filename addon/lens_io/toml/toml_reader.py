"""Reader of Aplanat's lens files: TOML to a prescription, with all errors of a file at once.

`docs/lens-files.md` describes the format, its ranges and the codes.
"""

from dataclasses import dataclass
from pathlib import Path

from ...errors import LensFileError
from ...optics.prescription import Configuration, Prescription
from . import toml_document
from .findings import Finding
from .lens_tables import read_diaphragm, read_focus, read_lens_table, read_zoom
from .optical_checks import CheckedPosition, check_dispersion, check_position
from .surface_tables import read_surfaces
from .toml_table import Findings, Table, show

FORMAT = "lens-description"
FORMAT_VERSIONS = (1,)
DOCUMENT_KEYS = ("format", "format_version", "lens", "diaphragm", "surface", "zoom", "focus")


@dataclass(frozen=True)
class LensFile:
    """A lens file that was read.

    Parameters
    ----------
    prescription : Prescription
    warnings : tuple of Finding
    path : Path or None
        None if it was not read from a file.
    """

    prescription: Prescription
    warnings: tuple[Finding, ...] = ()
    path: Path | None = None


def read_lens(path):
    """Read and check a lens file.

    Parameters
    ----------
    path : Path or str

    Returns
    -------
    LensFile

    Raises
    ------
    LensFileError
        With every error of the file.
    """
    content, reason = toml_document.read_bytes(path)
    name = str(path)
    if content is None:
        raise LensFileError(name, [Finding("E01", "", f"the file cannot be read: {reason}")])
    read = parse_lens(content, name)
    return LensFile(read.prescription, read.warnings, Path(path))


def parse_lens(content, file_name):
    """Read and check the content of a lens file.

    Parameters
    ----------
    content : bytes
    file_name : str
        For messages.

    Returns
    -------
    LensFile

    Raises
    ------
    LensFileError
        With every error of the file.
    """
    text, reason = toml_document.decode(content)
    if text is None:
        raise LensFileError(file_name, [Finding("E01", "", reason)])
    values, reason = toml_document.parse(text)
    if values is None:
        raise LensFileError(file_name, [Finding("E02", "", f"this is not TOML: {reason}")])
    findings = Findings(file_name)
    prescription = _read_document(values, findings)
    if findings.errors:
        findings.refuse()
    return LensFile(prescription, tuple(findings.warnings))


def _read_document(values, findings):
    document = Table(values, "", findings)
    _check_format(document)
    document.check_keys(DOCUMENT_KEYS)
    lens = read_lens_table(document)
    diaphragm = read_diaphragm(document)
    surface_tables = read_surfaces(document)
    zoom = read_zoom(document, surface_tables)
    focus = read_focus(document, surface_tables)
    surfaces = () if surface_tables is None else tuple(surface_tables.surfaces)
    check_dispersion(surfaces, findings)
    if surface_tables is not None and surface_tables.sound:
        for position in _checked_positions(document, surfaces, lens, zoom):
            check_position(position, findings)
    return Prescription(
        **lens, surfaces=surfaces, diaphragm=diaphragm, zoom=tuple(zoom), focus=focus
    )


def _checked_positions(document, surfaces, lens, zoom):
    """Yield what can be traced: the known zoom positions, or the lens itself without zoom."""
    if "zoom" not in document:
        nominal = (lens[name] for name in ("focal_length", "f_number", "half_field_deg"))
        yield CheckedPosition(Configuration(surfaces, *nominal))
        return
    for number, position in enumerate(zoom, 1):
        if position is not None:
            yield CheckedPosition(
                position.applied(surfaces), f"zoom[{number}]", frozenset(position.thicknesses)
            )


def _check_format(document):
    found = document.values.get("format")
    if found != FORMAT:
        what = "no format" if "format" not in document else f"format {_shown(found)}"
        document.add("E03", "format", f'found {what}; a lens file has format = "{FORMAT}"')
    version = document.values.get("format_version")
    if isinstance(version, bool) or not isinstance(version, int) or version not in FORMAT_VERSIONS:
        what = "none" if "format_version" not in document else _shown(version)
        known = ", ".join(map(str, FORMAT_VERSIONS))
        document.add(
            "E04", "format_version", f"found {what}; versions that this reader knows: {known}"
        )


def _shown(value):
    if isinstance(value, dict):
        return "a table"
    return "an array" if isinstance(value, list) else show(value)
