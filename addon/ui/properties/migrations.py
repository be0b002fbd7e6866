"""The version of the stored settings, and what brings those of older files up to it.

A property is stored under its name, a choice as its number, and only what was ever set is stored.
So a file of an older Aplanat opens as it is as long as names and numbers stay. What can not stay
gets a new name, a new version, and a step (`migration_steps`) that moves what was stored.

Each data-block tells the version of its own settings, as `settings_version` among what is stored,
so that one that is linked or appended is judged by what the Aplanat of its file wrote. It is
written when a file is saved. A data-block without it is of Aplanat 0.1, or was written to a file
without Blender telling (an autosave, the clipboard, `bpy.data.libraries.write`), or is a library
override, which Blender makes from the library's data-block and the user's changes, each of whatever
age. So a step leaves alone what is stored as it wants it already.

Steps run after a file is opened, on its own data-blocks and on those that it links, and after data-
blocks are linked, appended, pasted or reloaded. Nothing is written where no step is due: opening a
file changes nothing in it. Of a value that was never set nothing is stored, so no step can keep it:
a default that changes needs a new name as well. And what a library override changed is applied by
Blender under the property's name before any handler runs: where that name is gone it is lost. So a
setting that moves leaves its old property declared, hidden, for a step to read.
"""

import bpy
from bpy.app.handlers import persistent

from .migration_steps import STEPS

# What this Aplanat stores.
VERSION = 4

_VERSION_NAME = "settings_version"
# By the type of a data-block: the name of its collection.
_KINDS = {
    "SCENE": "scenes",
    "CAMERA": "cameras",
    "LIGHT": "lights",
    "MATERIAL": "materials",
    "WORLD": "worlds",
}


def stored_settings(block):
    """Return what is stored of a data-block's settings, or None; nothing is made to exist.

    Parameters
    ----------
    block : bpy.types.ID or bpy.types.ViewLayer

    Returns
    -------
    bpy.types.PropertyGroup or None
        The values by name, as a dict holds them.
    """
    group = block.bl_system_properties_get()
    return group.get("aplanat") if group is not None else None


def _owners(blocks):
    """Yield what has stored settings among data-blocks: kind, block and stored values."""
    for kind, block in blocks:
        stored = stored_settings(block)
        if stored is not None:
            yield kind, block, stored
        if kind == "scenes":
            yield from _owners(("view_layers", layer) for layer in block.view_layers)


def _all_blocks():
    return ((kind, block) for kind in _KINDS.values() for block in getattr(bpy.data, kind))


def migrate(blocks):
    """Bring the stored settings of data-blocks up to `VERSION`.

    Parameters
    ----------
    blocks : iterable of tuple of str and bpy.types.ID
        The kind, as a step gets it, and the data-block.
    """
    for kind, block, stored in _owners(blocks):
        version = stored.get(_VERSION_NAME, 0)
        due = [step for leads_to, step in sorted(STEPS.items()) if leads_to > version]
        for step in due:
            step(kind, block, stored)
        if due:
            stored[_VERSION_NAME] = VERSION


@persistent
def _migrate_opened(*_):
    migrate(_all_blocks())


@persistent
def _migrate_imported(context):
    """Bring what was linked, appended, pasted or reloaded up to `VERSION`."""
    found = (
        block
        for item in context.import_items
        for block in (item.id, item.library_override_id)
        if block is not None
    )
    migrate((_KINDS[block.id_type], block) for block in found if block.id_type in _KINDS)


@persistent
def _stamp(*_):
    """Write the version into the settings of the file's own data-blocks."""
    for *_, stored in _owners(pair for pair in _all_blocks() if pair[1].library is None):
        if stored.get(_VERSION_NAME) != VERSION:
            stored[_VERSION_NAME] = VERSION


def register():
    """Look after the files that are opened and saved, and what is brought in from others."""
    # Before the other handlers read settings.
    bpy.app.handlers.load_post.insert(0, _migrate_opened)
    bpy.app.handlers.blend_import_post.insert(0, _migrate_imported)
    bpy.app.handlers.save_pre.append(_stamp)


def unregister():
    """Undo `register`."""
    bpy.app.handlers.save_pre.remove(_stamp)
    bpy.app.handlers.blend_import_post.remove(_migrate_imported)
    bpy.app.handlers.load_post.remove(_migrate_opened)
