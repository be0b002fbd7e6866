"""`aplanat lens import`: a lens file of another program as one of ours."""

from pathlib import Path

from ...files.whole_file import check_writable, removed_on_signals, whole_file
from ...lens_io.importers import ImportOptions, import_lens
from ...lens_io.toml.toml_writer import lens_toml


def import_file(arguments, console):
    """Carry out `aplanat lens import`; parameters and result as `lens_command.lens`."""
    options = ImportOptions(
        thickness=arguments.thickness,
        stop=arguments.stop,
        radii=arguments.radii,
        f_number=arguments.f_number,
        half_field_deg=arguments.half_field,
        glasses=dict(arguments.glass),
    )
    with removed_on_signals():
        check_writable(arguments.output)
        imported = import_lens(arguments.file, options)
        content = lens_toml(imported.prescription).encode("utf-8")
        with whole_file(arguments.output) as place:
            Path(place).write_bytes(content)
    for line in imported.ignored:
        console.say(f"ignored: {line}")
    for found in imported.warnings:
        console.say(f"warning: {found.code} {found.path}: {found.message}")
    console.say(f"{imported.prescription.name} ({imported.format_name}): {arguments.output}")
    return {
        "command": "lens import",
        "name": imported.prescription.name,
        "format": imported.format_name,
        "files": [str(arguments.output)],
        "ignored": list(imported.ignored),
        "warnings": [found.as_json() for found in imported.warnings],
    }
