"""The node groups as assets: a folder in the built extension that the asset browser can show.

``python -m addon.compositor.asset_library FOLDER`` makes it; `scripts/build` calls that. An
installed Aplanat only adds the folder to the user's asset libraries when it is asked to.
"""

import sys
from pathlib import Path

import bpy

from .asset_previews import SIZE, preview_pixels
from .node_groups import GROUPS, new_group

FOLDER = "asset_library"
LIBRARY = "Aplanat"
_BLEND, _CATALOGS = "aplanat_compositing.blend", "blender_assets.cats.txt"
# Blender's own catalog, so that the groups stand beside its effects.
_CATALOG_ID = "81249800-1dfd-4eec-9257-20019aa3ef5d"
_CATALOG = "Compositing/Camera & Lens Effects"


def write_asset_library(folder):
    """Write the asset library: a .blend file with our node groups, and the list of catalogs.

    Parameters
    ----------
    folder : Path
        Is made if need be.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    trees = {name: new_group(name) for name in GROUPS}
    for name, tree in trees.items():
        tree.asset_mark()
        tree.asset_data.description = tree.description
        tree.asset_data.author = "The Aplanat developers"
        tree.asset_data.license = "GPL-3.0-or-later"
        tree.asset_data.catalog_id = _CATALOG_ID
        preview = tree.preview_ensure()
        preview.image_size = (SIZE, SIZE)
        preview.image_pixels_float.foreach_set(preview_pixels(name).ravel())
    bpy.data.libraries.write(
        str(folder / _BLEND), set(trees.values()), fake_user=True, compress=True
    )
    for tree in trees.values():
        bpy.data.node_groups.remove(tree)
    name = _CATALOG.replace("/", "-")
    text = f"# Catalogs of Aplanat's assets\n\nVERSION 1\n\n{_CATALOG_ID}:{_CATALOG}:{name}\n"
    (folder / _CATALOGS).write_text(text, encoding="utf-8")


def bundled_folder():
    """Return the folder of the asset library; None in a checkout, which has none."""
    folder = Path(__file__).resolve().parents[2] / FOLDER
    return folder if (folder / _BLEND).is_file() else None


def known_library(folder):
    """Return the user's asset library of a folder; None if there is none."""
    for library in bpy.context.preferences.filepaths.asset_libraries:
        if library.path and Path(bpy.path.abspath(library.path)).resolve() == folder:
            return library
    return None


def add_library(folder):
    """Add a folder to the user's asset libraries, unless it is among them.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    bool
        Whether it was added.
    """
    if known_library(folder) is not None:
        return False
    libraries = bpy.context.preferences.filepaths.asset_libraries
    libraries.new(name=LIBRARY, directory=str(folder))
    return True


if __name__ == "__main__":
    write_asset_library(Path(sys.argv[1]))
