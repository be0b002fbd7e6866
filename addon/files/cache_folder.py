"""The folder of cached files: what can be made again."""

import os
import sys
from pathlib import Path

CACHE_VARIABLE = "APLANAT_CACHE"


def cache_folder(kind):
    """Return the folder of a kind of cached files.

    ``APLANAT_CACHE``, or else the system's place for caches, has one folder for each kind.

    Parameters
    ----------
    kind : str
        Such as ``"levels"``.

    Returns
    -------
    Path
        It may not exist yet.
    """
    chosen = os.environ.get(CACHE_VARIABLE)
    if chosen:
        return Path(chosen) / kind
    home = Path.home()
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = home / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    return base / "aplanat" / kind
