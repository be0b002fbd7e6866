"""`aplanat lens`: information about real lenses, without starting Blender.

Each subcommand has its module, imported when it is used: a plotting library takes longer to load
than most answers to compute.
"""

import sys
from importlib import import_module

from ...errors import InputError
from ...lens_io.library import Library

# By subcommand: the module beside this one, and its function of arguments and console.
_WORDS = {
    "list": ("lens_list", "list_lenses"),
    "info": ("lens_info", "tell_facts"),
    "trace": ("lens_trace", "trace_lens"),
    "bake": ("lens_bake", "bake"),
    "plot": ("lens_plot", "plot"),
    "import": ("lens_import", "import_file"),
}


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
    from ...scene.camera.lenses import user_folder

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
    return library().open(word)


def tell_warnings(read, console):
    """Print a lens' warnings on stderr."""
    for found in read.warnings:
        console.say(f"warning: {found.code} {found.path}: {found.message}")
