"""The test scenes and reference pictures that may lie in a folder ``shared`` beside a checkout."""

import os
import subprocess
import sys
from pathlib import Path

import bpy

from addon.errors import InputError

_REPOSITORY = Path(__file__).resolve().parents[2]
_SHARED = _REPOSITORY.parent / "shared"
BUILT_FOLDER = _REPOSITORY / "build" / "scenes"

_NAMES = ("toys", "balls", "dragons", "fishes", "christmas_tree", "street", "toy_dinosaurs")


def is_shared_name(word):
    """Whether a word is the name of a shared scene rather than a file's."""
    return word in _NAMES


def shared_scene(name, look, console):
    """Return the .blend file of a shared scene, building it at its first use.

    Parameters
    ----------
    name : str
    look : {'flat', 'lit'}
    console : Console

    Raises
    ------
    InputError
        If the shared folder is not there or the scene cannot be built.
    """
    file = BUILT_FOLDER / f"{name}_{look}.blend"
    if file.is_file():
        return file
    builder = _SHARED / "scenes" / "build_scenes.py"
    if not builder.is_file():
        raise InputError(
            f"scene '{name}' is built from a folder '{_SHARED.name}' beside the checkout, which is"
            " not there; give the path of a .blend file"
        )
    if bpy.app.binary_path:
        raise InputError(f"scene '{name}' is built with scripts/aplanat only; give a .blend file")
    console.say(f"building scene {name} ({look})")
    BUILT_FOLDER.mkdir(parents=True, exist_ok=True)
    # Two processes may build one scene at once: each into a file of its own.
    part = file.with_name(f"part-{os.getpid()}-{file.name}")
    words = [sys.executable, builder, "--scene", name, "--look", look, "--out", part]
    # -B: nothing is written into the shared folder.
    words.insert(1, "-B")
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode or not part.is_file():
        raise InputError(f"scene '{name}' cannot be built: {done.stderr.strip()[-300:]}")
    part.replace(file)
    return file


def shared_references(name, look):
    """Return the reference pictures of a shared scene by kind, ``lens`` and ``pinhole``."""
    files = {
        "lens": _SHARED / "ref" / f"{name}_{look}_dof.exr",
        "pinhole": _SHARED / "ref" / f"{name}_{look}_pinhole.exr",
    }
    return {kind: file for kind, file in files.items() if file.is_file()}
