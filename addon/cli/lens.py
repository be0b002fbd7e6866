"""`aplanat lens`: looking into real lenses, without Blender and its start.

Each word has its module, imported when it is asked for: a drawing library takes longer to load than
most answers to compute.
"""

import sys
from importlib import import_module
from pathlib import Path

from ..errors import InputError, LensFileError
from ..lens_io.findings import Finding
from ..lens_io.library import Library
from ..lens_io.toml_reader import LensFile

# By word: the module beside this one, and what it does with arguments and console.
_WORDS = {
    "list": ("lens_list", "list_lenses"),
    "info": ("lens_info", "tell_facts"),
    "trace": ("lens_trace", "trace_lens"),
    "bake": ("lens_bake", "bake"),
    "plot": ("lens_plot", "plot"),
    "import": ("lens_import", "import_file"),
}
# Of the formats that can be imported.
_FOREIGN_ENDINGS = {".dat", ".zmx", ".seq", ".txt"}


def lens(arguments, console):
    """Carry out `aplanat lens`.

    Parameters
    ----------
    arguments : argparse.Namespace
    console : Console

    Returns
    -------
    dict
        What `--json` prints.

    Raises
    ------
    AplanatError
        If there is no such lens, or it cannot be used so.
    """
    module, function = _WORDS[arguments.lens_command]
    return getattr(import_module(f".{module}", __package__), function)(arguments, console)


def library():
    """Return the library: the shipped lenses, and within Blender also the user's.

    Returns
    -------
    Library
    """
    if "bpy" not in sys.modules:
        return Library()
    from ..scene.lenses import user_folder

    return Library([user_folder()])


def open_lens(word):
    """Read a lens of the library or of a file; one in a foreign format as `lens import` would.

    Parameters
    ----------
    word : str

    Returns
    -------
    LensFile

    Raises
    ------
    LensFileError
        If there is no such lens, or with every error of its file.
    """
    if not word:
        raise InputError("the lens has an empty name (see `aplanat lens list`)")
    path = Path(word)
    if path.suffix.lower() not in _FOREIGN_ENDINGS or not path.is_file():
        return library().open(word)
    from ..lens_io.importers import import_lens

    try:
        imported = import_lens(path)
    except LensFileError as error:
        raise _with_advice(error) from error
    return LensFile(imported.prescription, tuple(imported.warnings), path)


def tell_warnings(read, console):
    """Print a lens' warnings on stderr."""
    for found in read.warnings:
        console.say(f"warning: {found.code} {found.path}: {found.message}")


def _with_advice(error):
    # What a file leaves open is settled by options that only one word has.
    found = [
        Finding(one.code, one.path, f"{one.message} (options of `aplanat lens import`)")
        if one.code in ("I05", "I06")
        else one
        for one in error.findings
    ]
    return LensFileError(error.file_name, found, error.warnings)
