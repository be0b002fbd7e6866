"""Files of a capture: which are there already, and what is written into them besides the layers."""

import hashlib
from pathlib import Path

import bpy

from ..errors import InputError
from ..layers.layer_file import load_layers, load_words, save_layers

_DIGEST = "settingsDigest"
# Read at once, so that a large file is no reason to swap.
_CHUNK = 1 << 22


def source_digest(path):
    """Return a hash of a .blend file and of the libraries that it links.

    Parameters
    ----------
    path : Path
        Of the file that is open.

    Returns
    -------
    str
    """
    digest = hashlib.sha256()
    linked = (bpy.path.abspath(library.filepath) for library in bpy.data.libraries)
    for name in [str(path), *sorted(linked)]:
        try:
            with open(name, "rb") as file:
                while chunk := file.read(_CHUNK):
                    digest.update(chunk)
        # A library that is missing is told elsewhere.
        except OSError:
            digest.update(b"missing")
    return digest.hexdigest()


def is_captured(path, digest):
    """Whether a file has whole layers of these settings.

    Parameters
    ----------
    path : Path
    digest : str
        Of `CaptureSettings`.

    Returns
    -------
    bool
    """
    try:
        if not Path(path).is_file() or load_words(path).get(_DIGEST) != digest:
            return False
        load_layers(path)
    # Cut off, foreign, or of another version: it is captured again.
    except InputError:
        return False
    return True


def write_capture(path, stack, digest, software, words, half=False):
    """Write captured layers, whole or not at all.

    Parameters
    ----------
    path : Path
    stack : LayerStack
    digest : str
        Of `CaptureSettings`.
    software : str
    words : dict of str to str
        What the renderer says in its headers.
    half : bool
        Colours in half precision.

    Raises
    ------
    OutputError
    """
    words = {**words, _DIGEST: digest, "software": software}
    save_layers(path, stack, words=words, half=half)
