"""`aplanat lens list`: the lenses of the library."""

from ...errors import LensFileError
from ...lens_io.library import SHIPPED_FOLDER
from ...lens_io.toml.toml_reader import read_lens
from ..words.text_table import text_table
from .lens_command import library


def list_lenses(arguments, console):
    """Carry out `aplanat lens list`; parameters and result as `lens_command.lens`."""
    entries = [_entry(name, path) for name, path in sorted(library().paths().items())]
    if not arguments.json:
        console.answer(_text(entries))
    for entry in entries:
        for error in entry["errors"]:
            console.say(f"warning: lens '{entry['id']}' cannot be used: {error['message']}")
    return {"command": "lens list", "lenses": entries}


def _entry(lens_id, path):
    entry = {"id": lens_id, "file": str(path), "shipped": path.parent == SHIPPED_FOLDER}
    try:
        lens = read_lens(path).prescription
    except LensFileError as error:
        return entry | {"errors": [found.as_json() for found in error.findings]}
    settings = lens.configurations()
    return entry | {
        "name": lens.name,
        "focal_length_mm": [setting.focal_length for setting in settings],
        "f_number": [setting.f_number for setting in settings],
        "half_field_deg": [setting.half_field_deg for setting in settings],
        "zoom": [position.label for position in lens.zoom],
        "errors": [],
    }


def _text(entries):
    rows = [["id", "name", "mm", "f/", "field", "file"]]
    for entry in entries:
        if entry["errors"]:
            rows.append([entry["id"], "(cannot be used)", "", "", "", entry["file"]])
            continue
        rows.append(
            [
                entry["id"],
                entry["name"],
                _range(entry["focal_length_mm"]),
                _range(entry["f_number"]),
                f"{_range([2.0 * half for half in entry['half_field_deg']])}°",
                "shipped" if entry["shipped"] else entry["file"],
            ]
        )
    return text_table(rows, right={2, 3, 4})


def _range(values):
    first, last = (f"{value:.3g}" for value in (values[0], values[-1]))
    return first if first == last else f"{first}-{last}"
