"""`aplanat lens bake`: the bokeh tables of a lens in one EXR file.

The file holds what the renderer reads (the ray map of axial points and the off-axis pupil) and the
table of a point at 1 m over sensor position and radius.
"""

from importlib.util import find_spec
from pathlib import Path

from ...errors import InputError
from ...files.version import version
from ...files.whole_file import check_writable, removed_on_signals
from ...lens_bokeh.tables.profile import make_profile, profile_table
from ...lens_bokeh.tables.pupil_parts import pack
from ...lens_bokeh.tables.pupil_tracing import build_pupil_tables
from ...lens_io.profile_cache import content_hash
from ...lens_io.profile_file import StoredProfile, save_profile
from ...optics.glass import C_LINE_NM, F_LINE_NM, REFERENCE_WAVELENGTH_NM
from .lens_command import open_lens, tell_warnings

# Of the off-axis pupil in colour: lateral colour bends over the spectrum as two further ones show.
_PUPIL_WAVELENGTHS = (REFERENCE_WAVELENGTH_NM, F_LINE_NM, C_LINE_NM)


def bake(arguments, console):
    """Carry out `aplanat lens bake`; parameters and result as `lens_command.lens`."""
    if find_spec("OpenEXR") is None:
        raise InputError("the package OpenEXR is missing; install Aplanat from its extension zip")
    with removed_on_signals():
        check_writable(arguments.output)
        read = open_lens(arguments.lens)
        tell_warnings(read, console)
        prescription = read.prescription
        configuration = prescription.configuration(arguments.zoom)
        if not configuration.of_revolution:
            raise InputError(
                f"lens '{prescription.name}' has cylinders; bokeh tables are made for lenses of"
                " revolution"
            )
        stored = _tables(read, configuration, arguments, console)
        lens_id = read.path.stem if read.path else Path(arguments.lens).stem
        key = content_hash(prescription, configuration.label)
        save_profile(arguments.output, stored, lens_id=lens_id, content_hash=key)
    console.say(f"{prescription.name}: {arguments.output}")
    return {
        "command": "lens bake",
        "name": prescription.name,
        "label": configuration.label,
        "hash": key,
        "channels": stored.profile.channels,
        "rows": len(stored.table.planes),
        "radii": stored.table.density.shape[1],
        "row_energy_error": float(abs(stored.table.energies - 1.0).max()),
        "files": [str(arguments.output)],
        "warnings": [found.as_json() for found in read.warnings],
    }


def lens_profile(read, arguments, console):
    """Make the bokeh profile of a lens.

    Parameters
    ----------
    read : LensFile
    arguments : argparse.Namespace
        With ``chromatic`` and ``zoom``.
    console : Console

    Returns
    -------
    LensProfile

    Raises
    ------
    PrescriptionError
        If the lens forms no image.
    """
    return make_profile(
        read.prescription.configuration(arguments.zoom),
        name=read.prescription.name,
        focus_group=read.prescription.focus,
        chromatic=arguments.chromatic,
        progress=_told(console, "bokeh profile"),
    )


def _tables(read, configuration, arguments, console):
    profile = lens_profile(read, arguments, console)
    table = profile_table(profile, progress=_told(console, "bokeh table"))
    pupil = build_pupil_tables(
        configuration,
        _PUPIL_WAVELENGTHS if arguments.chromatic else _PUPIL_WAVELENGTHS[:1],
        progress=_told(console, "off-axis pupil"),
    )
    words, pictures = pack(pupil)
    return StoredProfile(profile, table, words | {"software": f"Aplanat {version()}"}, pictures)


def _told(console, what):
    return lambda share: console.progress(f"{what}: {share:.0%}")
