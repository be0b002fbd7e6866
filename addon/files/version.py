"""The extension's version, from the one place where it is written."""

import tomllib
from functools import cache
from pathlib import Path

_MANIFEST = Path(__file__).resolve().parents[2] / "blender_manifest.toml"


# Memo of a file that comes with Aplanat.
@cache
def version():
    """Return the version of blender_manifest.toml."""
    with _MANIFEST.open("rb") as file:
        return tomllib.load(file)["version"]
